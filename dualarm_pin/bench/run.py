"""BenchRun: one method on one variant of one task with one seed, and what came of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.bench.columns import Row, of_run

Status = Literal["ok", "not_found", "failed", "crashed", "timed_out"]
STATUSES: tuple[Status, ...] = ("ok", "not_found", "failed", "crashed", "timed_out")


@dataclass(frozen=True)
class InputHashes:
    """What a variant of a task is made of.

    Attributes:
        task: sha256 of the content of the task file, changes applied.
        cell: sha256 of the content of the cell file, changes applied.
        robots: sha256 of every URDF, SRDF, collision mesh and path file, by the end of its
            path.
        files: sha256 of the bytes of all files by absolute path, those two included: a worker
            refuses to run when a file changed after the batch began.
    """

    task: str
    cell: str
    robots: Mapping[str, str]
    files: Mapping[str, str]

    @property
    def digest(self) -> str:
        """One sha256 for all of it; the same in any folder and on any machine."""
        return digest([self.task, self.cell, sorted(self.robots.values())])

    def record(self) -> dict[str, Any]:
        """Return what a row says of it."""
        return {
            "digest": self.digest,
            "task": self.task,
            "cell": self.cell,
            "robots": dict(self.robots),
        }


@dataclass(frozen=True)
class Method:
    """A method with its options.

    Attributes:
        name: Name in tables.
        planner: A method of `planners.dispatch`, or None with `call`.
        call: `module:function`, or None.
        options: Arguments of the planner or of the function.
    """

    name: str
    planner: str | None
    call: str | None
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class BenchRun:
    """Everything that defines one run.

    Attributes:
        task: Name of the task in tables.
        file: Task file, absolute.
        overrides: Changes by dotted key.
        inputs: Fingerprints of what the task is made of.
        method: The method.
        seed: Seed of its starts.
        time_limit: Budget [s].
        version: Version of the package.
        allow_code: The task may name functions of its own.
    """

    task: str
    file: str
    overrides: Mapping[str, Any]
    inputs: InputHashes
    method: Method
    seed: int
    time_limit: float
    version: str
    allow_code: bool = False

    @property
    def key(self) -> str:
        """sha256 of all that defines the run; names in tables do not."""
        return digest(
            {
                "inputs": self.inputs.digest,
                "overrides": dict(self.overrides),
                "planner": self.method.planner,
                "call": self.method.call,
                "options": dict(self.method.options),
                "seed": self.seed,
                "time_limit": self.time_limit,
                "version": self.version,
            }
        )

    @property
    def problem(self) -> tuple[str, str]:
        """Task and variant: runs with the same one can be compared."""
        return self.task, variant_name(self.overrides)


@dataclass(frozen=True)
class RunOutcome:
    """What came of a run.

    Attributes:
        status: How it ended.
        reason: Why, if it is not `ok`.
        figures: The other columns of its row.
        trajectory: The answer, where the method returned one and it is wanted.
        task_file: The task as solved (YAML), with the trajectory.
    """

    status: Status
    reason: str = ""
    figures: Mapping[str, Any] = field(default_factory=dict)
    trajectory: Trajectory | None = None
    task_file: str | None = None

    def row(self, run: BenchRun) -> Row:
        """Return the row of the table, JSON values only."""
        asked = of_run(run)
        head = {"status": self.status, "reason": self.reason, "found": False}
        return asked | head | {k: v for k, v in self.figures.items() if k not in asked}


def changes(overrides: Mapping[str, Any]) -> tuple[str, ...]:
    """Return overrides as the `key=value` texts that `Task.load` takes; JSON is YAML."""
    return tuple(f"{key}={json.dumps(value)}" for key, value in overrides.items())


def variant_name(overrides: Mapping[str, Any]) -> str:
    """Return overrides as one line, empty for none."""
    return ", ".join(
        f"{key}={value if isinstance(value, str) else json.dumps(value)}"
        for key, value in overrides.items()
    )


def digest(value: Any) -> str:
    """Return the sha256 of a JSON value, whatever the order of its keys."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()

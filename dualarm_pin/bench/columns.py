"""The columns of a batch, one entry each: add an entry, and every reader has it.

The row on disk and the table files hold all columns; what is `kept` is there for gates, maps and
the report, and what is `shown` stands in the report's table of each task.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dualarm_pin.answer.result_json import result_json
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.answer.trajectory import Trajectory
    from dualarm_pin.bench.run import BenchRun
    from dualarm_pin.task import Task

Row = dict[str, Any]
_RANKED = ("arc_mean_index", "max_index", "timing.cpu_s", "run_s")  # beside those that are shown
_LARGEST = 2**63  # tables hold whole numbers in 64 bits
Rule = Literal["best", "least", "median", "largest", "typical"]


@dataclass(frozen=True)
class Answered:
    """What a column can be made from where a method has answered.

    Attributes:
        task: The task.
        trajectory: The answer.
        started: When the method was called.
        seconds: How long it took, the check of the harness included.
    """

    task: Task
    trajectory: Trajectory
    started: datetime
    seconds: float


@dataclass(frozen=True)
class Shown:
    """How a column stands in the report's table of a task, where a method has one line.

    Attributes:
        heading: What the head says, with its unit.
        rule: Which value of its runs: that of the run with the lowest objective of those found
            (`best`); the least or the median of those found, or of all that ended if none was; the
            largest, or the median (`typical`), of all that ended.
        form: Format of the number.
        bad: Tells whether a value is marked as bad.
        least: Mark the least of all methods.
    """

    heading: str
    rule: Rule
    form: str
    bad: Callable[[float], bool] = lambda value: False
    least: bool = False


@dataclass(frozen=True)
class Column:
    """A column of the table of a batch.

    Attributes:
        name: Its name; `a.b` is `b` of the record `a`. Without `run` and `answer` it is what
            `result.json`, or the end of the run, says under this name.
        run: Makes it from what was asked, so that it is there whatever comes of the run.
        answer: Makes it from an answer, where the run was done.
        kept: Gates, maps and the report read it. The others stay on disk, however long the batch.
        text: It has other keys in every row, so it is JSON text in the table files.
        shown: Its places in the report's table of a task.
    """

    name: str
    run: Callable[[BenchRun], Any] | None = None
    answer: Callable[[Answered], Any] | None = None
    kept: bool = True
    text: bool = False
    shown: Sequence[Shown] = ()


@lru_cache(maxsize=1)
def machine() -> dict[str, Any]:
    """Return what the times were measured on."""
    processor = platform.processor()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        processor = next(x.partition(":")[2].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):  # not Linux, or a processor without a name
        pass
    return {
        "host": platform.node(),
        "system": f"{platform.system()} {platform.release()}",
        "processor": processor or platform.machine(),
        "cores": os.cpu_count(),
    }


def _above(limit: float) -> Callable[[float], bool]:
    return lambda value: value > limit


COLUMNS: tuple[Column, ...] = (
    Column("key", run=lambda run: run.key),
    Column("task", run=lambda run: run.task),
    Column("variant", run=lambda run: run.problem[1]),
    Column("set", run=lambda run: dict(run.overrides)),
    Column("method", run=lambda run: run.method.name),
    Column("planner", run=lambda run: run.method.planner or run.method.call),
    Column("options", run=lambda run: dict(run.method.options), kept=False, text=True),
    Column("seed", run=lambda run: run.seed),
    Column("time_limit", run=lambda run: run.time_limit),
    Column("inputs", run=lambda run: run.inputs.record(), kept=False),
    *(Column(name) for name in ("status", "reason", "found")),
    Column("objective", shown=[Shown("objective, best found", "best", ".5g", least=True)]),
    Column(
        "mean_index",
        shown=[
            Shown("mean index, best", "least", ".4g"),
            Shown("mean index, median", "median", ".4g"),
        ],
    ),
    *(Column(name) for name in ("arc_mean_index", "max_index")),
    Column(
        "max_bound_violation",
        shown=[Shown("bound violation, largest", "largest", ".2g", _above(TOLERANCE.bound))],
    ),
    Column(
        "max_position_error",
        shown=[Shown("position error, largest [m]", "largest", ".1e", _above(TOLERANCE.position))],
    ),
    Column(
        "max_rotation_error",
        shown=[
            Shown("rotation error, largest [rad]", "largest", ".1e", _above(TOLERANCE.rotation))
        ],
    ),
    Column("min_clearance", shown=[Shown("clearance [m]", "best", ".3f", lambda v: v <= 0.0)]),
    *(
        Column(f"clearance_check.{name}")
        for name in ("required", "level", "kept", "smallest_at_points", "bound")
    ),
    Column(
        "clearance_check.smallest_between_points",
        shown=[Shown("clearance between points [m]", "best", ".3f", lambda v: v <= 0.0)],
    ),
    Column("max_joint_step", shown=[Shown("joint step", "best", ".3f")]),
    Column("timing.wall_s", shown=[Shown("time, median [s]", "typical", ".3g")]),
    *(Column(f"timing.{name}") for name in ("cpu_s", "compile_s")),
    *(Column(f"evidence.{name}") for name in ("verdict", "lower_bound", "gap", "missed_share_95")),
    Column("run_s", answer=lambda answered: answered.seconds),
    Column("started", answer=lambda done: done.started.isoformat("T", "milliseconds"), kept=False),
    Column("index_name", answer=lambda answered: answered.task.index.name),
    Column("index_units", answer=lambda answered: answered.task.index.units),
    Column("smoothness", answer=lambda answered: answered.task.smoothness),
    Column("machine", answer=lambda answered: machine(), kept=False),
    *(Column(f"machine.{name}") for name in ("host", "system", "processor", "cores")),
    *(
        Column(name, kept=False, text=True)
        for name in ("inputs.robots", "evidence.details", "units", "extra")
    ),
)


def of_run(run: BenchRun) -> Row:
    """Return the columns that say which run a row is about."""
    return {column.name: column.run(run) for column in COLUMNS if column.run is not None}


def of_answer(answered: Answered) -> Row:
    """Return the columns that an answer adds, those of `result.json` among them."""
    made = {c.name: c.answer(answered) for c in COLUMNS if c.answer is not None}
    told = result_json(answered.trajectory)
    del told["checked"]  # point by point: in the result folders that are kept
    return told | made


def flatten(row: Mapping[str, Any], prefix: str = "") -> Row:
    """Return a row without nested records: `evidence.verdict`, `timing.wall_s`, ..."""
    texts = {column.name for column in COLUMNS if column.text}
    flat: Row = {}
    for key, value in row.items():
        name = f"{prefix}{key}"
        if name in texts:
            flat[name] = json.dumps(value)
        elif isinstance(value, Mapping):
            flat |= flatten(value, f"{name}.")
        else:
            flat[name] = value
    return flat


def first_wrong(row: Mapping[str, Any]) -> str | None:
    """Return the first column of a row read back that holds what no run leaves there, or None.

    A log is a file like any other: it may have been cut, merged or edited.
    """
    flat = flatten(row)
    for name, kind in (("found", bool), ("status", str), ("reason", str), ("set", Mapping)):
        if not isinstance(row.get(name), kind):
            return name
    if not isinstance(flat.get("evidence.verdict"), str | None):
        return "evidence.verdict"
    for column in COLUMNS:
        value = flat.get(column.name)
        number = column.shown or column.name in _RANKED
        if value is not None and number and (isinstance(value, bool) or not _is_number(value)):
            return column.name
    return next((name for name, value in flat.items() if not _fits_a_table(name, value)), None)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and abs(value) < _LARGEST


def _fits_a_table(*values: Any) -> bool:
    """Tell whether all of them are what JSON of ours holds: numbers in range, whole texts."""
    for value in values:
        if isinstance(value, list):
            fits = _fits_a_table(*value)
        elif isinstance(value, Mapping):
            fits = _fits_a_table(*value, *value.values())
        elif isinstance(value, str):
            fits = not any("\ud800" <= letter <= "\udfff" for letter in value)
        else:
            fits = value is None or _is_number(value)
        if not fits:
            return False
    return True


def brief(row: Row) -> Row:
    """Return what gates, maps and the report read of a row, flat."""
    flat = flatten(row) | {"set": row["set"]}
    return {column.name: flat.get(column.name) for column in COLUMNS if column.kept}

"""Trajectory: the answer of a planner, with what was checked and where it came from.

A result folder holds `result.json`, `trajectory.csv`, `trajectory.npz` and `task.yaml`; scripts
rely on their keys and columns.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.write import replacing, write_text

Array = NDArray[np.float64]
UNITS = {"angle": "rad", "length": "m", "time": "s"}


@dataclass(frozen=True)
class Timing:
    """Seconds spent: wall clock, processor (workers included), compilation."""

    wall_s: float = 0.0
    cpu_s: float = 0.0
    compile_s: float = 0.0


@dataclass(frozen=True)
class LawCount:
    """What the starts of one law came to.

    Attributes:
        starts: How many were made.
        converged: How many ended feasible and converged.
        minima: How many distinct minima they found (by joints, then objective).
        best_hits: How many ended in the best minimum of all laws.
        singletons: Minima that one start alone led to.
        twins: Other minima with the objective of the best, such as mirror images.
        second_best: Lowest objective of another minimum; None if there is none.
        last_improvement: Number of the start that first found the best, from 1; None if none did,
            or the law does not number them.
    """

    starts: int
    converged: int
    minima: int
    best_hits: int
    singletons: int = 0
    twins: int = 0
    second_best: float | None = None
    last_improvement: int | None = None


@dataclass(frozen=True)
class Evidence:
    """What is known about the optimum; null is what the effort did not cover.

    Attributes:
        verdict: `local_only`, `best_known` or `best_known_bounded`.
        laws: Counts by the name of the start law.
        missed_share_95: A better optimum that these starts can reach draws less than this share
            of them (95 %).
        stationarity: Largest KKT residual of the polished answer.
        curvature_min: Smallest eigenvalue of the reduced Hessian.
        active_bounds: Number of joint bounds that hold the answer.
        lower_bound: Estimated lower bound of the objective, re-checked.
        gap: (objective - lower_bound) / objective.
        details: Further figures by name; see `dualarm_pin.evidence`.
    """

    verdict: str = "local_only"
    laws: Mapping[str, LawCount] = field(default_factory=dict)
    missed_share_95: float | None = None
    stationarity: float | None = None
    curvature_min: float | None = None
    active_bounds: int | None = None
    lower_bound: float | None = None
    gap: float | None = None
    details: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint motion along the whole path, as checked with Pinocchio.

    Attributes:
        q: Joints (h, n) in column order [rad or m].
        joints: Names of the columns, `arm1/<name>` and `arm2/<name>`.
        arc_length: Arc length of each point (h,) [m].
        index: Index at each point (h,).
        found: Every point passed our own check of pose and bounds.
        method: Name of the planner.
        solver: Name of the solver.
        objective: Objective (19) over all points.
        arc_mean_index: Mean of the index over the arc length.
        max_position_error: Largest position error [m].
        max_rotation_error: Largest rotation error [rad].
        max_bound_violation: Largest violation of a bound [rad or m].
        max_joint_step: Largest step of one joint between neighbours [rad or m].
        min_clearance: Smallest distance of the collision pairs [m]; None if geometry is missing.
        clearance: Clearance at each point (h,) [m], or None.
        evidence: What is known about the optimum.
        timing: Seconds.
        seed: Seed of the starts.
        versions: Versions of the libraries that made the result.
        message: In one sentence: why it was not found, or what to know about it.
        extra: Further figures of the method.
    """

    q: Array
    joints: tuple[str, ...]
    arc_length: Array
    index: Array
    found: bool
    method: str
    solver: str
    objective: float
    arc_mean_index: float
    max_position_error: float
    max_rotation_error: float
    max_bound_violation: float
    max_joint_step: float
    min_clearance: float | None = None
    clearance: Array | None = None
    evidence: Evidence = field(default_factory=Evidence)
    timing: Timing = field(default_factory=Timing)
    seed: int | None = None
    versions: Mapping[str, str] = field(default_factory=dict)
    message: str = ""
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def mean_index(self) -> float:
        """Plain mean of the index over the points, as the paper reports it."""
        return float(np.mean(self.index))

    @property
    def max_index(self) -> float:
        """Largest index on the path."""
        return float(np.max(self.index))

    @property
    def arm_clearance(self) -> float | None:
        """Smallest distance between the two arms on the path [m]; None if unknown."""
        values = self.extra.get("arm_clearance")
        return None if values is None else float(np.min(values))

    def as_dict(self) -> dict[str, Any]:
        """Return the content of `result.json`; what is not a finite number becomes null."""
        keys = (
            "found method solver objective mean_index arc_mean_index max_index index "
            "max_position_error max_rotation_error max_bound_violation max_joint_step "
            "min_clearance clearance seed message"
        )
        result = {key: getattr(self, key) for key in keys.split()}
        result["evidence"] = asdict(self.evidence)
        result["timing"] = asdict(self.timing)
        result |= {"versions": self.versions, "joints": self.joints, "units": UNITS}
        result["extra"] = self.extra
        clean = _plain(result)
        assert isinstance(clean, dict)
        return clean

    def save(self, folder: str | Path) -> None:
        """Write `result.json`, `trajectory.csv` and `trajectory.npz` into `folder`.

        Each file appears whole or not at all, `result.json` last.

        Raises:
            InputError: The folder cannot be written.
        """
        folder = Path(folder)
        write_text(folder / "trajectory.csv", self._csv())
        with replacing(folder / "trajectory.npz") as temporary:
            np.savez(
                temporary,
                q=self.q,
                index=self.index,
                arc_length=self.arc_length,
                joints=np.array(self.joints, dtype=np.str_),
            )
        write_text(folder / "result.json", json.dumps(self.as_dict(), indent=1) + "\n")

    @classmethod
    def load(cls, folder: str | Path) -> Trajectory:
        """Read a result folder.

        Raises:
            MissingFileError: It holds no result.
            InputError: Its files do not fit together.
        """
        folder = Path(folder)
        result = _read_json(folder / "result.json")
        try:
            with np.load(folder / "trajectory.npz", allow_pickle=False) as arrays:
                q, index, arc_length = arrays["q"], arrays["index"], arrays["arc_length"]
                joints = tuple(str(name) for name in arrays["joints"])
        except FileNotFoundError as error:
            raise MissingFileError("no such file", file=folder / "trajectory.npz") from error
        except (OSError, ValueError, KeyError) as error:
            raise InputError(
                f"not a trajectory of this program: {error}", file=folder / "trajectory.npz"
            ) from error
        try:
            evidence = dict(result["evidence"])
            evidence["laws"] = {k: LawCount(**v) for k, v in evidence["laws"].items()}
            clearance = result.get("clearance")
            return cls(
                q=q,
                joints=joints,
                arc_length=arc_length,
                index=index,
                clearance=None if clearance is None else np.asarray(clearance, dtype=float),
                evidence=Evidence(**evidence),
                timing=Timing(**result["timing"]),
                **{
                    key: _number(result[key])
                    for key in (
                        "found method solver objective arc_mean_index max_position_error "
                        "max_rotation_error max_bound_violation max_joint_step"
                    ).split()
                },
                min_clearance=result["min_clearance"],
                seed=result["seed"],
                versions=result["versions"],
                message=result.get("message", ""),
                extra=result.get("extra", {}),
            )
        except (KeyError, TypeError, AttributeError) as error:
            raise InputError(
                f"not a result of this program: {error}", file=folder / "result.json"
            ) from error

    def _csv(self) -> str:
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["point", "arc_length", *self.joints, "index"])
        for i, (s, q, c) in enumerate(zip(self.arc_length, self.q, self.index, strict=True), 1):
            writer.writerow([i, *(repr(float(x)) for x in (s, *q, c))])
        return text.getvalue()


def _read_json(file: Path) -> dict[str, Any]:
    try:
        result = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise MissingFileError(
            "no result here: give the folder that `solve --out` wrote", file=file
        ) from error
    except ValueError as error:
        raise InputError(f"not JSON: {error}", file=file) from error
    if not isinstance(result, dict):
        raise InputError("not a result of this program", file=file)
    return result


def _number(value: Any) -> Any:
    return math.nan if value is None else value


def _plain(value: Any) -> Any:
    """Return JSON values; NaN and infinity do not exist there and become null."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray | list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value

"""What is in `result.json`: one function that writes it, one that reads it.

Scripts rely on the keys: they may grow, none may change its meaning. What is not a finite number
is null. Points are counted from 1.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, cast

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter
from pydantic_core import from_json, to_json

from dualarm_pin.answer.alternatives import alternatives_json
from dualarm_pin.answer.apart_json import ApartFile, LinesFile, apart_json, lines_json, read_apart
from dualarm_pin.answer.evidence import Bound, Count, Evidence, LocalCheck, Number
from dualarm_pin.answer.notes import NOTES
from dualarm_pin.answer.provenance import Timing
from dualarm_pin.answer.trajectory import Checked, Distances, RowValues, Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import Pair

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")
UNITS = {"angle": "rad", "length": "m", "time": "s"}


def result_json(trajectory: Trajectory) -> dict[str, Any]:
    """Return the content of `result.json`."""
    t, checked = trajectory, trajectory.checked
    clearance, arms = checked.clearance, checked.arm_clearance
    extra = {} if t.notes is None else asdict(t.notes)
    if t.evidence.sentences:
        extra["evidence_text"] = t.evidence.sentences
    extra["smallest_singular_value"] = checked.singular_value
    extra["arm_clearance"] = None if arms is None else arms.distance
    content = {
        "found": t.found,
        "method": t.method,
        "solver": t.solver,
        "objective": t.objective,
        "mean_index": t.mean_index,
        "arc_mean_index": t.arc_mean_index,
        "max_index": t.max_index,
        "index": t.index,
        "max_position_error": t.max_position_error,
        "max_rotation_error": t.max_rotation_error,
        "max_bound_violation": t.max_bound_violation,
        "max_constraint_violation": t.max_row_violation,
        "max_joint_step": t.max_joint_step,
        "min_clearance": t.min_clearance,
        "closest_pair": None if clearance is None else clearance.closest,
        "min_arm_clearance": t.arm_clearance,
        "clearance": None if clearance is None else clearance.distance,
        "clearance_check": apart_json(checked),
        "seed": t.seed,
        "message": t.message,
        "evidence": _evidence(t.evidence),
        "alternatives": alternatives_json(t),
        "timing": asdict(t.timing),
        "versions": t.versions,
        "joints": t.joints,
        "units": UNITS,
        "extra": extra,
        "checked": {
            "position_error": checked.position_error,
            "rotation_error": checked.rotation_error,
            "bound_violation": checked.bound_violation,
            "smoothing_error": checked.smoothing_error,
            "clearance_pairs": () if clearance is None else clearance.pairs,
            "arm_clearance_pairs": () if arms is None else arms.pairs,
            "between": lines_json(checked),
            "constraints": [
                {**asdict(row), "points": _from_1(row.points), "violation": row.violation}
                for row in checked.rows
            ],
        },
    }
    text = to_json(content, inf_nan_mode="null", fallback=lambda array: array.tolist())
    plain: dict[str, Any] = from_json(text)
    return plain


def _evidence(evidence: Evidence) -> dict[str, Any]:
    local, bound = evidence.local, evidence.bound
    content = {
        "verdict": evidence.verdict,
        "laws": {name: asdict(law) for name, law in evidence.laws.items()},
        "missed_share_95": evidence.missed_share_95,
        "stationarity": local and local.stationarity,
        "curvature_min": local and local.curvature_min,
        "active_bounds": local and local.active_bounds,
        "lower_bound": evidence.lower_bound,
        "gap": evidence.gap,
    }
    if local is None:
        return content | {"details": {}}
    details = {key: value for key, value in asdict(local).items() if key not in content}
    details |= {
        "local": local.kind,
        "near_singular": local.near_singular,
        "costliest_joint": local.costliest_joint,
        "searches": evidence.searches and asdict(evidence.searches),
        "laws_agree": evidence.laws_agree,
        "unseen_share": {name: law.unseen_share for name, law in evidence.laws.items()},
        "expected_better": {name: law.expected_better for name, law in evidence.laws.items()},
        "stopping_rule": evidence.stopping_rule,
        "stopping_rule_met": evidence.stopping_rule_met,
        "bound_pieces": bound and bound.pieces,
        "piece_starts": bound and bound.starts,
        "piece_hits": bound and bound.hits,
    }
    if bound is not None:
        details |= {
            "bound_cuts": _from_1(bound.cuts),
            "bound_condition": bound.condition,
            "bound_contradicted": bound.contradicted,
            "bound_seconds": bound.seconds,
            "bound_complete": bound.complete,
            "bound_tried": [
                {"cuts": _from_1(cuts), "bound": value} for cuts, value in bound.tried.items()
            ],
            "bound_found_better": bound.found_better,
            "bound_replaced": bound.replaced,
            "bound_without_clearance": bound.without_clearance,
        }
    return content | {"details": details}


def read_result_json(text: bytes, q: Array, index: Array, arc_length: Array) -> Trajectory:
    """Return the trajectory of a `result.json` of this version or one before.

    Args:
        text: Content of the file.
        q: Joints (h, n), from the file beside it, as the index and the arc length.
        index: Index (h,).
        arc_length: Arc length (h,) [m].

    Raises:
        pydantic.ValidationError: A key is missing or of another type.
        InputError: The arrays do not fit together.
    """
    file = _File.model_validate_json(text, strict=True)
    points, extra = file.checked, _typed(_Extra, file.extra)

    def by_point(stored: list[float] | None, largest: float) -> Array:
        # Version 0.1.0 kept the largest alone: no point is worse.
        return np.full(len(q), largest) if stored is None else np.array(stored)

    def distances(stored: list[float] | None, pairs: tuple[Pair, ...]) -> Distances | None:
        return None if stored is None else Distances(np.array(stored), pairs)

    return Trajectory(
        q=q,
        joints=file.joints,
        arc_length=arc_length,
        checked=Checked(
            index=index,
            objective=file.objective,
            position_error=by_point(points.position_error, file.max_position_error),
            rotation_error=by_point(points.rotation_error, file.max_rotation_error),
            bound_violation=by_point(points.bound_violation, file.max_bound_violation),
            singular_value=by_point(extra.smallest_singular_value, math.nan),
            clearance=distances(file.clearance, points.clearance_pairs),
            arm_clearance=distances(extra.arm_clearance, points.arm_clearance_pairs),
            found=file.found,
            rows=tuple(
                RowValues(
                    row.name, row.units, row.equality, _from_0(row.points), np.array(row.value)
                )
                for row in points.constraints
            ),
            smoothing_error=points.smoothing_error,
            apart=read_apart(file.clearance_check, points.between),
        ),
        method=file.method,
        solver=file.solver,
        evidence=_read_evidence(file.evidence, extra.evidence_text),
        timing=file.timing,
        seed=file.seed,
        versions=file.versions,
        message=file.message,
        notes=_read_notes(file.method, file.extra),
    )


def _read_evidence(content: dict[str, Any], sentences: str) -> Evidence:
    """Return the evidence; `details` and the keys beside it are one record."""
    details = _typed(dict[str, Any], content.get("details", {}))
    flat = {**content, **details}
    flat.pop("local", None)  # derived, as other keys that no record holds
    evidence = replace(_typed(Evidence, flat), sentences=sentences)
    if not details:
        return evidence
    bound = None
    if flat.get("lower_bound") is not None:
        named = {field.name: flat.get(f"bound_{field.name}") for field in fields(Bound)}
        renamed = {"value": "lower_bound", "starts": "piece_starts", "hits": "piece_hits"}
        tried = _typed(tuple[_Tried, ...], named.pop("tried"))
        named |= {name: flat.get(key) for name, key in renamed.items()}
        bound = _typed(Bound, named | {"objective": flat.get("objective")})
        bound = replace(
            bound,
            cuts=_from_0(bound.cuts),
            tried={_from_0(each.cuts): each.bound for each in tried},
        )
    return replace(evidence, local=_typed(LocalCheck, flat), bound=bound)


def _read_notes(method: str, extra: Mapping[str, Any]) -> DataclassInstance | None:
    """Return the notes of a method of this package, where it left any."""
    record = NOTES.get(method)
    if record is None or not any(field.name in extra for field in fields(record)):
        return None
    return _typed(record, extra)


class _Spec(BaseModel):
    """What is read of an object: other keys are left alone."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class _Tried(_Spec):
    cuts: tuple[Count, ...]
    bound: Number


class _Extra(_Spec):
    """Figures of the check and the sentences; the rest are the notes of the method."""

    evidence_text: str = ""
    smallest_singular_value: list[Number] | None = None
    arm_clearance: list[Number] | None = None


class _Row(_Spec):
    name: str
    units: str
    equality: bool
    points: tuple[Count, ...]
    value: list[Number]


class _Points(_Spec):
    """Further figures at each point."""

    position_error: list[Number] | None = None
    rotation_error: list[Number] | None = None
    bound_violation: list[Number] | None = None
    clearance_pairs: tuple[Pair, ...] = ()
    arm_clearance_pairs: tuple[Pair, ...] = ()
    between: LinesFile | None = None
    constraints: tuple[_Row, ...] = ()
    smoothing_error: Number = 0.0


class _File(_Spec):
    found: bool
    method: str
    solver: str
    objective: Number
    max_position_error: Number
    max_rotation_error: Number
    max_bound_violation: Number
    clearance: list[Number] | None = None
    clearance_check: ApartFile | None = None
    seed: Annotated[int, Field(ge=0, lt=2**128)] | None
    message: str = ""
    evidence: dict[str, Any]
    timing: Timing
    versions: dict[str, str]
    joints: tuple[str, ...]
    extra: dict[str, Any] = {}
    checked: _Points = _Points()


def _typed(kind: type[T], content: Any) -> T:
    """Return JSON values as a record; nothing is converted."""
    record: T = _reader(cast(Any, kind)).validate_json(json.dumps(content), strict=True)
    return record


@cache
def _reader(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)  # it takes longer to make one than to read


def _from_1(points: tuple[int, ...]) -> list[int]:
    return [point + 1 for point in points]


def _from_0(points: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(point - 1 for point in points)

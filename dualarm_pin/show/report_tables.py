"""The tables of a report: result, evidence, provenance, all as text."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.evidence import Bound, Evidence
from dualarm_pin.answer.trajectory import Apart, Distances, RowValues, Trajectory
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Rows = list[tuple[str, list[str]]]

_VERDICTS = {
    "local_only": "a local minimum; too little was searched to say more",
    "best_known": "best known of the starts below",
    "best_known_bounded": "best known, with a lower bound that holds as far as its search went",
}


def tables_of(results: Sequence[tuple[Task, Trajectory]]) -> dict[str, Rows]:
    """Return rows of text by section; a row that no result fills is left out."""

    def rows(*lines: tuple[str, Callable[[Task, Trajectory], str]]) -> Rows:
        filled = [(name, [text(*result) for result in results]) for name, text in lines]
        return [line for line in filled if any(line[1])]

    # Of answers that minimise the same: what a clearance or another bound costs.
    same = {(task.index.name, task.smoothness, task.path.h) for task, _ in results}
    found = [t.objective for _, t in results if t.found]
    least = min(found) if len(results) > 1 and len(same) == 1 and found else None

    def above(_: Task, t: Trajectory) -> str:
        if least is None or not t.found or least <= 0.0:
            return ""
        return f"{100 * (t.objective / least - 1):.3g} %"

    return {
        "Result": rows(
            ("found", lambda _, t: "yes" if t.found else "NO"),
            ("method", lambda _, t: t.method),
            ("solver", lambda _, t: t.solver),
            ("mean index", lambda task, t: _number(t.mean_index, units_of(task))),
            ("mean over arc length", lambda task, t: _number(t.arc_mean_index, units_of(task))),
            ("largest index", lambda task, t: _number(t.max_index, units_of(task))),
            ("objective", lambda _, t: _number(t.objective, digits=7)),
            ("above the lowest objective", above),
            ("smallest clearance", lambda _, t: _clearance(t.checked.clearance)),
            ("clearance asked for", lambda _, t: _asked(t.checked.apart)),
            ("between the points", lambda _, t: _between(t.checked.apart)),
            ("arms apart by", lambda _, t: _number(t.arm_clearance, "m")),
            ("largest joint step", lambda _, t: _number(t.max_joint_step, "rad or m")),
            ("bounds violated by", lambda _, t: _number(t.max_bound_violation)),
            ("constraints", lambda _, t: _constraints(t)),
            ("position error", lambda _, t: _number(t.max_position_error, "m")),
            ("rotation error", lambda _, t: _number(t.max_rotation_error, "rad")),
            ("message", lambda _, t: t.message),
        ),
        "Evidence": rows(
            ("verdict", lambda _, t: _verdict(t.evidence)),
            ("in words", lambda _, t: " ".join(t.evidence.sentences.split())),
            ("starts", lambda _, t: _laws(t.evidence)),
            (
                "a better optimum draws less than",
                lambda _, t: _share(t.evidence.missed_share_95, " of the starts (95 %)"),
            ),
            ("lower bound", lambda _, t: _bound(t.evidence.bound)),
            ("gap to it", lambda _, t: _share(t.evidence.gap)),
            ("known without clearance", lambda _, t: _without_clearance(t)),
            ("stationarity", lambda _, t: _local(t.evidence, "stationarity")),
            ("smallest curvature", lambda _, t: _local(t.evidence, "curvature_min")),
            ("bounds that hold", lambda _, t: _local(t.evidence, "active_bounds")),
        ),
        "Provenance": rows(
            ("seed", lambda _, t: "" if t.seed is None else str(t.seed)),
            ("time", _time),
            ("versions", lambda _, t: "\n".join(f"{k} {v}" for k, v in t.versions.items())),
            (
                "files read (SHA-256)",
                lambda task, _: "\n".join(
                    f"{s.path.name} {s.sha256[:16]}…" for s in task.cell.sources
                ),
            ),
        ),
    }


def units_of(task: Task) -> str:
    """Return the units of the index as a page shows them."""
    return task.index.units.replace("^2", "²")


def _verdict(evidence: Evidence) -> str:
    wrong = evidence.bound is not None and evidence.bound.contradicted
    return _VERDICTS[evidence.verdict] + ("; the lower bound is wrong" if wrong else "")


def _laws(evidence: Evidence) -> str:
    return "\n".join(
        f"{name}: {law.starts} starts, {law.converged} converged, "
        f"{law.minima} minima, best hit {law.best_hits}×"
        for name, law in evidence.laws.items()
    )


def _local(evidence: Evidence, name: str) -> str:
    return "" if evidence.local is None else _number(getattr(evidence.local, name))


def _bound(bound: Bound | None) -> str:
    if bound is None:
        return ""
    wrong = ", above this very path: a search missed a minimum, or the bound is wrong"
    text = _number(bound.value, digits=7) + (wrong if bound.contradicted else "")
    return text if bound.without_clearance is None else f"{text}\nmade without clearance"


def _without_clearance(t: Trajectory) -> str:
    """Say what the answer costs beside the best path that keeps none."""
    bound = t.evidence.bound
    if bound is None or bound.without_clearance is None or bound.without_clearance <= 0.0:
        return ""
    above = _share(t.objective / bound.without_clearance - 1.0)
    return f"{_number(bound.without_clearance, digits=7)}; the answer lies {above} above"


def _clearance(clearance: Distances | None) -> str:
    if clearance is None:
        return "unknown"
    text = _number(clearance.least, "m") + (" IN COLLISION" if clearance.touch else "")
    pair = clearance.closest
    return text if pair is None else f"{text}\n{pair[0]} - {pair[1]}"


_LEVELS = {
    "points": "looked at the points alone",
    "samples": "sampled between the points, not certified",
    "certified": "certified between the points",
}


def _asked(apart: Apart | None) -> str:
    if apart is None:
        return ""
    what = "of single pairs" if apart.required is None else _number(apart.required, "m")
    if apart.kept:
        return f"{what}: kept, {_LEVELS[apart.level]}"
    return f"{what}: NOT KEPT\n{apart.worst}"


def _between(apart: Apart | None) -> str:
    if apart is None or apart.between is None:
        return ""
    line = int(np.argmin(apart.between))
    text = f"{_number(apart.least_between, 'm')}, after point {line + 1}"
    if apart.bound is not None:
        text += f"\nnowhere below {apart.bound:.4g} m"
    return f"{text}\n{' - '.join(apart.pairs[line])}"


def _constraints(t: Trajectory) -> str:
    """Say of each row how much room is left where it is least, or how far it is violated."""
    return "\n".join(f"{row.name}: {_room(row)} at point {row.worst + 1}" for row in t.checked.rows)


def _room(row: RowValues) -> str:
    if row.violation > TOLERANCE.row:
        return f"VIOLATED by {_number(row.violation, row.units)}"
    least = float(np.max(np.abs(row.value)) if row.equality else np.min(row.value))
    return f"{'off by' if row.equality else 'room'} {max(least, 0.0):.4f} {row.units}"


def _time(_: Task, t: Trajectory) -> str:
    spent = (
        ("wall", t.timing.wall_s),
        ("processor", t.timing.cpu_s),
        ("compiling", t.timing.compile_s),
    )
    return "\n".join(f"{name} {_number(seconds, 's')}" for name, seconds in spent)


def _share(value: float | None, text: str = "") -> str:
    return "" if value is None else f"{100 * value:.2g} %{text}"


def _number(value: float | None, units: str = "", digits: int = 4) -> str:
    if value is None or not math.isfinite(value):
        return ""
    text = f"{value:.{digits}g}" if isinstance(value, float) else str(value)
    return f"{text} {units}".strip()

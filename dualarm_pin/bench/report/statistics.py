"""What a table comes to: one summary a task and method, profiles, shifted geometric means."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Row = Mapping[str, Any]
Problem = tuple[str, str]
SHIFT = 1.0  # seconds; keeps runs of milliseconds from ruling a geometric mean


@dataclass(frozen=True)
class Summary:
    """The runs of one method on one task and variant.

    Attributes:
        problem: Task and variant.
        method: Name of the method.
        runs: How many there are.
        found: How many were verified.
        statuses: How many ended in which way.
        objective: Best objective (19) of those found.
        mean_index: Best mean index of those found; of all that ended if none was.
        median_index: Median of the mean index over those found; over all that ended if none was.
        bound_violation: Largest violation of a bound of all that ended [rad or m].
        pose_error: Largest position or rotation error of all that ended [m or rad].
        joint_step: Largest joint step in the best of those found [rad or m].
        clearance: Smallest clearance of the best of those found [m], None if unknown.
        time: Median wall time of all that ended [s].
        verdict: What the evidence of the best says.
        gap: Its gap to the lower bound.
    """

    problem: Problem
    method: str
    runs: int
    found: int
    statuses: Counter[str]
    objective: float | None
    mean_index: float | None
    median_index: float | None
    bound_violation: float | None
    pose_error: float | None
    joint_step: float | None
    clearance: float | None
    time: float | None
    verdict: str
    gap: float | None


def summaries(rows: Iterable[Row]) -> dict[Problem, list[Summary]]:
    """Return a summary for each method of each problem, in the order of the suite."""
    groups: dict[Problem, dict[str, list[Row]]] = {}
    for row in rows:
        group = groups.setdefault((row["task"], row["variant"]), {})
        group.setdefault(row["method"], []).append(row)
    return {
        problem: [_summary(problem, method, runs) for method, runs in group.items()]
        for problem, group in groups.items()
    }


def _summary(problem: Problem, method: str, runs: Sequence[Row]) -> Summary:
    ended = [row for row in runs if _value(row, "mean_index") is not None]
    found = [row for row in ended if row["found"]]
    best = min(found, key=lambda row: _value(row, "objective") or math.inf, default=None)
    judged = found or ended
    means = [row["mean_index"] for row in judged]

    def largest(*columns: str) -> float | None:
        values = [v for row in ended for c in columns if (v := _value(row, c)) is not None]
        return max(values, default=None)

    times = [row["timing.wall_s"] for row in ended if _value(row, "timing.wall_s") is not None]
    return Summary(
        problem=problem,
        method=method,
        runs=len(runs),
        found=len(found),
        statuses=Counter(row["status"] for row in runs),
        objective=_value(best, "objective"),
        mean_index=min(means, default=None),
        median_index=statistics.median(means) if means else None,
        bound_violation=largest("max_bound_violation"),
        pose_error=largest("max_position_error", "max_rotation_error"),
        joint_step=_value(best, "max_joint_step"),
        clearance=_value(best, "min_clearance"),
        time=statistics.median(times) if times else None,
        verdict=(best or {}).get("evidence.verdict") or "",
        gap=_value(best, "evidence.gap"),
    )


def shifted_geometric_mean(values: Sequence[float], shift: float = SHIFT) -> float | None:
    """Return exp(mean(log(v + shift))) - shift, or None without values."""
    if not values:
        return None
    return math.exp(statistics.fmean(math.log(value + shift) for value in values)) - shift


def times(rows: Iterable[Row]) -> dict[str, list[float]]:
    """Return the wall times by method; a run that found nothing counts with its time limit."""
    return _by_method(
        rows, lambda row: _value(row, "timing.wall_s") if row["found"] else row["time_limit"]
    )


def excesses(rows: Sequence[Row]) -> dict[str, list[float]]:
    """Return how far each objective is above the best of its problem, by method.

    1 + (objective - best) / |best|, over all methods and seeds; infinite for a run that found
    nothing, so that a low objective off the path or outside the bounds counts for nothing.
    """
    best: dict[Problem, float] = {}
    for row in rows:
        if row["found"] and _value(row, "objective") is not None:
            problem = (row["task"], row["variant"])
            best[problem] = min(best.get(problem, math.inf), row["objective"])

    def excess(row: Row) -> float:
        value = _value(row, "objective")
        if not row["found"] or value is None:
            return math.inf
        least = best[row["task"], row["variant"]]
        return 1.0 + (value - least) / max(abs(least), 1e-12)

    return _by_method(rows, excess)


def time_ratios(rows: Sequence[Row]) -> dict[str, list[float]]:
    """Return wall times over the fastest of the same problem and seed, by method."""
    fastest: dict[tuple[str, str, int], float] = {}
    for row in rows:
        value = _value(row, "timing.wall_s")
        if row["found"] and value is not None:
            place = (row["task"], row["variant"], row["seed"])
            fastest[place] = min(fastest.get(place, math.inf), max(value, 1e-6))

    def ratio(row: Row) -> float:
        value = _value(row, "timing.wall_s")
        if not row["found"] or value is None:
            return math.inf
        return max(value, 1e-6) / fastest[row["task"], row["variant"], row["seed"]]

    return _by_method(rows, ratio)


def profile(ratios: Sequence[float]) -> list[tuple[float, float]]:
    """Return the performance profile of Dolan and More: steps (ratio, share of runs within it)."""
    finite = sorted(ratio for ratio in ratios if math.isfinite(ratio))
    return [(ratio, (i + 1) / len(ratios)) for i, ratio in enumerate(finite)]


def _by_method(
    rows: Iterable[Row], figure: Callable[[Row], float | None]
) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for row in rows:
        value = figure(row)
        if value is not None:
            found.setdefault(row["method"], []).append(value)
    return found


def _value(row: Row | None, column: str) -> float | None:
    value = None if row is None else row.get(column)
    return float(value) if isinstance(value, int | float) else None

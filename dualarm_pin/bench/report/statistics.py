"""What a table comes to: one summary a task and method, profiles, shifted geometric means."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

from dualarm_pin.bench import columns
from dualarm_pin.bench.columns import Rule, Shown

Row = Mapping[str, Any]
Problem = tuple[str, str]
SHIFT = 1.0  # seconds; keeps runs of milliseconds from ruling a geometric mean


@dataclass(frozen=True)
class Summary:
    """The runs of one method on one task and variant.

    Attributes:
        method: Name of the method.
        found: How many were verified.
        statuses: How many ended in which way.
        figures: Value of every shown column by its heading, None where there is none.
        verdict: What the evidence of the best says.
        gap: Its gap to the lower bound.
    """

    method: str
    found: int
    statuses: Counter[str]
    figures: Mapping[str, float | None]
    verdict: str
    gap: float | None


def summaries(rows: Iterable[Row]) -> dict[Problem, list[Summary]]:
    """Return a summary for each method of each problem, in the order of the suite."""
    groups: dict[Problem, dict[str, list[Row]]] = {}
    for row in rows:
        group = groups.setdefault((row["task"], row["variant"]), {})
        group.setdefault(row["method"], []).append(row)
    return {
        problem: [_summary(method, runs) for method, runs in group.items()]
        for problem, group in groups.items()
    }


def shown_columns() -> list[tuple[str, Shown]]:
    """Return the name and the look of every column of a task's table, in order."""
    return [(column.name, shown) for column in columns.COLUMNS for shown in column.shown]


def _summary(method: str, runs: Sequence[Row]) -> Summary:
    ended = [row for row in runs if _value(row, "mean_index") is not None]
    found = [row for row in ended if row["found"]]
    valued = [row for row in found if _value(row, "objective") is not None]
    best = min(valued, key=lambda row: float(row["objective"]), default=None)
    return Summary(
        method=method,
        found=len(found),
        statuses=Counter(row["status"] for row in runs),
        figures={
            shown.heading: _figure(name, shown.rule, ended, found, best)
            for name, shown in shown_columns()
        },
        verdict=(best or {}).get("evidence.verdict") or "",
        gap=_value(best, "evidence.gap"),
    )


def _figure(
    name: str, rule: Rule, ended: Sequence[Row], found: Sequence[Row], best: Row | None
) -> float | None:
    """Return the value of a column that stands for all runs; the rules are those of `Shown`."""
    if rule == "best":
        return _value(best, name)
    judged = ended if rule in ("largest", "typical") else found or ended
    values = [value for row in judged if (value := _value(row, name)) is not None]
    if not values:
        return None
    if rule == "largest":
        return max(values)
    return min(values) if rule == "least" else statistics.median(values)


def shifted_geometric_mean(values: Sequence[float], shift: float = SHIFT) -> float | None:
    """Return exp(mean(log(v + shift))) - shift, or None without values."""
    if not values:
        return None
    return math.exp(statistics.fmean(math.log(value + shift) for value in values)) - shift


def times(rows: Iterable[Row]) -> dict[str, list[float]]:
    """Return the wall times by method; a run that found nothing counts with its time limit."""
    return _by_method(
        (row, _value(row, "timing.wall_s") if row["found"] else row["time_limit"]) for row in rows
    )


def excesses(rows: Iterable[Row]) -> dict[str, list[float]]:
    """Return how far each objective is above the best of its problem, by method.

    1 + (objective - best) / |best|, over all methods and seeds; infinite for a run that found
    nothing, so that a low objective off the path or outside the bounds counts for nothing.
    """

    def excess(value: float, best: float) -> float:
        return 1.0 + (value - best) / max(abs(best), 1e-12)

    return _compared(rows, "objective", ("task", "variant"), excess)


def time_ratios(rows: Iterable[Row]) -> dict[str, list[float]]:
    """Return wall times over the fastest of the same problem and seed, by method."""

    def ratio(value: float, fastest: float) -> float:
        return max(value, 1e-6) / max(fastest, 1e-6)

    return _compared(rows, "timing.wall_s", ("task", "variant", "seed"), ratio)


def _compared(
    rows: Iterable[Row],
    column: str,
    place: Sequence[str],
    compare: Callable[[float, float], float],
) -> dict[str, list[float]]:
    """Compare each run with the least that was found at its place; infinite if it found nothing."""
    least: dict[Any, float] = {}
    at = itemgetter(*place)
    valued = [(row, _value(row, column) if row["found"] else None) for row in rows]
    for row, value in valued:
        if value is not None:
            least[at(row)] = min(least.get(at(row), math.inf), value)
    return _by_method(
        (row, math.inf if value is None else compare(value, least[at(row)]))
        for row, value in valued
    )


def profile(ratios: Sequence[float]) -> list[tuple[float, float]]:
    """Return the performance profile of Dolan and More: steps (ratio, share of runs within it)."""
    finite = sorted(ratio for ratio in ratios if math.isfinite(ratio))
    return [(ratio, (i + 1) / len(ratios)) for i, ratio in enumerate(finite)]


def _by_method(figures: Iterable[tuple[Row, float | None]]) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for row, value in figures:
        if value is not None:
            found.setdefault(row["method"], []).append(value)
    return found


def _value(row: Row | None, column: str) -> float | None:
    value = None if row is None else row.get(column)
    return float(value) if isinstance(value, int | float) else None

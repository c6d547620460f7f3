"""Tables of the report, as HTML; every name is escaped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from dualarm_pin.bench.columns import Shown
from dualarm_pin.bench.gates import Gate
from dualarm_pin.bench.report import statistics as stats
from dualarm_pin.bench.report.statistics import Summary
from dualarm_pin.tolerance import TOLERANCE


def gates_table(gates: Sequence[tuple[Gate, str | None]]) -> str:
    """Return which gates hold, empty without any."""
    if not gates:
        return ""
    lines = []
    for gate, failure in gates:
        spec, verdict = gate.spec, f"fails: {failure}" if failure else "holds"
        lines.append(
            f"<tr><th>{escape(gate.text)}</th>{_words(spec.of)}{_words(spec.method)}"
            f"{_words(spec.task)}{_words(verdict, f' {verdict[:5]}')}</tr>"
        )
    table = _table(["gate", "of", "method", "task", "verdict"], lines, words=5)
    return f"<h2>Gates</h2>{table}"


def overview_table(rows: Sequence[Mapping[str, Any]], methods: Sequence[str]) -> str:
    """Return one line a method over all tasks."""
    times, excesses = stats.times(rows), stats.excesses(rows)
    lines = []
    for method in methods:
        own = [row for row in rows if row["method"] == method]
        found = sum(row["found"] for row in own)
        ended = Counter(row["status"] for row in own if row["status"] not in ("ok", "not_found"))
        finite = [value for value in excesses.get(method, []) if value != float("inf")]
        violation = max((row["max_bound_violation"] or 0.0 for row in own), default=0.0)
        excess = stats.shifted_geometric_mean(finite, 0.0)
        reasons = ", ".join(f"{n} {s.replace('_', ' ')}" for s, n in ended.items())
        lines.append(
            f"<tr><th>{escape(method)}</th>{_share(found, len(own))}"
            f"{_number(None if excess is None else excess - 1.0, '.2%')}"
            f"{_number(violation, '.2g', 'bad' if violation > TOLERANCE.bound else '')}"
            f"{_number(stats.shifted_geometric_mean(times.get(method, [])), '.3g')}"
            f"{_words(reasons)}</tr>"
        )
    head = [
        "method",
        "found",
        "objective above best, geometric mean of those found",
        "largest bound violation of all [rad or m]",
        f"time, shifted geometric mean (shift {stats.SHIFT:g} s) [s]",
        "ended otherwise",
    ]
    return _table(head, lines) + (
        '<p class="quiet">A run that found nothing counts with its time limit in the mean time.</p>'
    )


def problem_table(group: Sequence[Summary]) -> str:
    """Return the methods on one task side by side, one column for each that is shown."""
    looks = [shown for _, shown in stats.shown_columns()]
    least = {}
    for shown in looks:
        values = [v for s in group if (v := s.figures[shown.heading]) is not None]
        if shown.least and values:
            near = TOLERANCE.same_objective * max(1.0, abs(min(values)))
            least[shown.heading] = min(values) + near
    lines = [
        f"<tr><th>{escape(s.method)}</th>{_share(s.found, s.statuses.total())}"
        f"{''.join(_figure(s, shown, least.get(shown.heading)) for shown in looks)}"
        f"{_words(_evidence(s))}</tr>"
        for s in group
    ]
    headings = [shown.heading for shown in looks]
    return _table(["method", "found", *headings, "evidence of the best"], lines)


def _figure(s: Summary, shown: Shown, least: float | None) -> str:
    value = s.figures[shown.heading]
    if value is None:
        unknown = shown.rule == "best" and s.found
        return f'<td class="none">{"unknown" if unknown else "none"}</td>'
    mark = "bad" if shown.bad(value) else "best" if least is not None and value <= least else ""
    return _number(value, shown.form, mark)


def _evidence(s: Summary) -> str:
    text = s.verdict.replace("_", " ")
    if s.gap is not None:
        text += f", gap {s.gap:.2%}"
    odd = [f"{n} {status.replace('_', ' ')}" for status, n in s.statuses.items() if status != "ok"]
    return "; ".join(filter(None, [text, *odd]))


def _table(names: Sequence[str], lines: Sequence[str], words: int = 1) -> str:
    """Return a table; its first columns, as many as `words`, and the last hold text."""
    head = "".join(
        f'<th scope="col"{" class=words" if i < words or i == len(names) - 1 else ""}>'
        f"{escape(name)}</th>"
        for i, name in enumerate(names)
    )
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(lines)}</tbody></table></div>"
    )


def _words(text: str, mark: str = "") -> str:
    return f'<td class="words{mark}">{escape(text)}</td>'


def _number(value: float | None, form: str, kind: str = "") -> str:
    if value is None:
        return '<td class="none">none</td>'
    mark = f' class="{kind}"' if kind else ""
    return f"<td{mark}>{value:{form}}</td>"


def _share(found: int, runs: int) -> str:
    mark = "" if found == runs else ' class="bad"'
    return f"<td{mark}>{found} of {runs}</td>"

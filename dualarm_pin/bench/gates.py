"""Gates: conditions on the finished table that decide the exit code."""

from __future__ import annotations

import operator
import re
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from dualarm_pin.errors import InputError, nearest
from dualarm_pin.files.suite_spec import GateEntry

_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
    "==": operator.eq,
}
_FORM = re.compile(r"^\s*([\w.\-]+)\s*(<=|>=|==|<|>)\s*(\S+)\s*$")
_TRUTH = {"true": 1.0, "false": 0.0}


@dataclass(frozen=True)
class Gate:
    """A condition: `column comparison limit` of some rows.

    Attributes:
        spec: As the suite says it: of which rows, and which of them must hold.
        column: Column of the table.
        comparison: `<=`, `>=`, `<`, `>` or `==`.
        limit: The number.
    """

    spec: GateEntry
    column: str
    comparison: str
    limit: float

    @property
    def text(self) -> str:
        """The condition."""
        return self.spec.gate.strip()

    def failure(self, rows: Iterable[Mapping[str, Any]]) -> str | None:
        """Return why the gate does not hold, or None if it does.

        A run without the value, such as one that failed, fails the gate `of: every`, `median` or
        `mean`.
        """
        of, falls = self.spec.of, self.comparison.startswith("<")
        chosen = [
            row
            for row in rows
            if fnmatchcase(row["task"], self.spec.task)
            and fnmatchcase(row["method"], self.spec.method)
        ]
        if not chosen:
            return "no run to judge"
        empty = [row for row in chosen if _number(row.get(self.column)) is None]
        values = [v for v in (_number(row.get(self.column)) for row in chosen) if v is not None]
        if not values:
            known = {key for row in chosen for key, v in row.items() if _number(v) is not None}
            return f"no run has a {self.column} ({nearest(self.column, sorted(known))})"
        if empty and of != "best":
            first = empty[0]
            return (
                f"{len(empty)} of {len(chosen)} runs have no {self.column}, such as "
                f"{first['method']} on {first['task']} with seed {first['seed']} "
                f"({first['status']})"
            )
        if of == "every":
            bad = [v for v in values if not _COMPARISONS[self.comparison](v, self.limit)]
            if not bad:
                return None
            worst = max(bad) if falls else min(bad)
            return f"{len(bad)} of {len(values)} runs do not hold it, the worst has {worst:.6g}"
        if of == "best":
            value = min(values) if falls else max(values)
        else:
            value = statistics.median(values) if of == "median" else statistics.fmean(values)
        held = _COMPARISONS[self.comparison](value, self.limit)
        return None if held else f"the {of} is {value:.6g}"


def read_gate(spec: GateEntry, tasks: Sequence[str], methods: Sequence[str]) -> Gate:
    """Read a gate of a suite.

    Raises:
        InputError: It has another form, or is about no task or method of the suite.
    """
    form = _FORM.match(spec.gate)
    try:
        if form is None:
            raise ValueError
        column, comparison, text = form.groups()
        limit = _TRUTH[text] if text in _TRUTH else float(text)
    except ValueError:
        raise InputError(
            f"not a condition: {spec.gate!r}; give a column, one of "
            f"{' '.join(_COMPARISONS)} and a number, such as `mean_index <= 0.41`"
        ) from None
    for what, pattern, names in (("task", spec.task, tasks), ("method", spec.method, methods)):
        if not any(fnmatchcase(name, pattern) for name in names):
            raise InputError(
                f"no {what} of this suite is called {pattern!r}: {nearest(pattern, names)}"
            )
    return Gate(spec, column, comparison, limit)


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, bool | int | float) else None

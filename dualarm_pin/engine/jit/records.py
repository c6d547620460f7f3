"""Which records compiled code reads by address: the problem and what it is made of."""

from __future__ import annotations

from dualarm_pin.chain import Chain
from dualarm_pin.engine.arrow_problem import ArrowProblem, Border
from dualarm_pin.engine.jit.by_reference import by_reference
from dualarm_pin.problem import Bounds, IndexTerms, Links, Neighbours, Points, Problem
from dualarm_pin.rows.table import RowTable

for _record in (Chain, Points, Links, Neighbours, IndexTerms, Bounds, RowTable):
    by_reference(_record, _record._fields)
_READ = (
    "chain",
    "points",
    "links",
    "neighbours",
    "terms",
    "bounds",
    "equalities",
    "inequalities",
    "row_count",
)
by_reference(Problem, _READ)
# One point of a problem with shared columns is a problem like any other to compiled code.
by_reference(ArrowProblem, (*_READ, "alone", "held", "border"))
by_reference(Border, Border._fields)

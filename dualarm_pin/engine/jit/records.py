"""Which records compiled code reads by address: the problem and what it is made of."""

from __future__ import annotations

from dualarm_pin.chain import Chain
from dualarm_pin.engine.jit.by_reference import by_reference
from dualarm_pin.problem import Bounds, IndexTerms, Links, Neighbours, Points, Problem
from dualarm_pin.rows.table import RowTable

for _record in (Chain, Points, Links, Neighbours, IndexTerms, Bounds, RowTable):
    by_reference(_record, _record._fields)
by_reference(
    Problem,
    (
        "chain",
        "points",
        "links",
        "neighbours",
        "terms",
        "bounds",
        "equalities",
        "inequalities",
        "row_count",
    ),
)

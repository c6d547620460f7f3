"""What may be said about an optimum: a local check, starts by two laws, a lower bound.

* `check_minimum`: polish, KKT residual, reduced Hessian, active limits, nearby starts. It shows a
  strict local minimum, no more.
* `count_laws`: how often two independent ways of starting ended here, and which share of the
  starts a better path must stay under.
* `lower_bound`: no better path below it, unless the search of a piece missed a minimum;
  `bound_minimum` also takes over a better path found on the way.
* `conclude`: the verdict, the record that goes into `result.json`, and three sentences.
* `examine`: all of that for a path from elsewhere.

`Evidence.details` holds, besides the fields of `Evidence`: `local` (not_stationary, saddle,
flat_minimum or strict_minimum), `objective`, `feasibility` (largest pose residual),
`min_multiplier` (of the active limits), `free_directions`, `sigma_min` (smallest singular value
of any point's Jacobian without the joints at their limits) with `near_singular`, `return_radius`
[rad a point] and `return_share` of nearby re-solves, `adopted_from_nearby`, `limit_cost` by joint
[objective per rad or m], `costliest_joint`, `laws_agree`, `unseen_share` and `expected_better` by
law (rough), `stopping_rule` with `stopping_rule_met`, and of the bound its pieces, cuts (points
from 1), starts and hits of each piece's minimum, the sets of cuts tried, and its condition.
"""

from dualarm_pin.evidence.ascent import BoundOptions
from dualarm_pin.evidence.bound import Bound, bound_minimum, lower_bound
from dualarm_pin.evidence.check import LocalCheck, check_minimum
from dualarm_pin.evidence.examine import examine
from dualarm_pin.evidence.laws import count_laws
from dualarm_pin.evidence.verdict import Findings, conclude

__all__ = [
    "Bound",
    "BoundOptions",
    "Findings",
    "LocalCheck",
    "bound_minimum",
    "check_minimum",
    "conclude",
    "count_laws",
    "examine",
    "lower_bound",
]

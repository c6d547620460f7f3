"""What may be said about an optimum: a local check, starts by two laws, a lower bound.

* `check_minimum`: polish, KKT residual, reduced Hessian, active limits, nearby starts. It shows a
  strict local minimum, no more.
* `count_laws`: how often two independent ways of starting ended here, and which share of the
  starts a better path must stay under.
* `lower_bound`: no better path below it, unless the search of a piece missed a minimum;
  `bound_minimum` also takes over a better path found on the way.
* `conclude`: the verdict, the record that every answer holds (`answer.evidence.Evidence`), and
  three sentences.
* `examine`: all of that for a path from elsewhere.
"""

from dualarm_pin.answer.evidence import Bound, Evidence, LocalCheck
from dualarm_pin.evidence.ascent import BoundOptions
from dualarm_pin.evidence.bound import bound_minimum, lower_bound
from dualarm_pin.evidence.check import check_minimum
from dualarm_pin.evidence.examine import examine
from dualarm_pin.evidence.laws import count_laws
from dualarm_pin.evidence.verdict import Findings, conclude

__all__ = [
    "Bound",
    "BoundOptions",
    "Evidence",
    "Findings",
    "LocalCheck",
    "bound_minimum",
    "check_minimum",
    "conclude",
    "count_laws",
    "examine",
    "lower_bound",
]

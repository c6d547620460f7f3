"""What must hold at the points of a path: the pose rows (eq. 17), and rows of the user's own.

`above`, `below`, `half_space`, `axis_within` and `capsules` make a `Row`, `inside` and
`joint_range` several; any function of the pose of one body in another makes one too: `Row("name",
"arm1/tip", "arm2/tip", phi)`.
"""

from dualarm_pin.rows.angles import axis_within, joint_range
from dualarm_pin.rows.capsules import capsules
from dualarm_pin.rows.half_space import above, below, half_space, inside
from dualarm_pin.rows.row import Row

__all__ = [
    "Row",
    "above",
    "axis_within",
    "below",
    "capsules",
    "half_space",
    "inside",
    "joint_range",
]

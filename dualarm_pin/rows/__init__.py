"""What must hold at the points of a path: the pose rows (eq. 17), and rows of the user's own.

`above`, `below` and `half_space` make a `Row`; any function of the pose of one body in another
makes one too: `Row("name", "arm1/tip", "arm2/tip", phi)`.
"""

from dualarm_pin.rows.half_space import above, below, half_space
from dualarm_pin.rows.row import Row

__all__ = ["Row", "above", "below", "half_space"]

"""How a Newton step is made: the one part of the interior point that knows the system's shape.

Compiled code calls the functions here; which one it is follows from the type of the problem.
"""

from __future__ import annotations

from dualarm_pin.engine.interior_point import arrow
from dualarm_pin.engine.interior_point import newton as plain
from dualarm_pin.engine.interior_point.objective import all_derivatives
from dualarm_pin.engine.interior_point.restoration import restore
from dualarm_pin.engine.jit.compiled import by_type

derivatives = by_type(all_derivatives, arrow.derivatives, "held")
factor = by_type(plain.factor_system, arrow.factor_system, "held")
newton = by_type(plain.newton_step, arrow.newton_step, "held")
new_multipliers = by_type(plain.newton_multipliers, arrow.newton_multipliers, "held")
restoration = by_type(restore, arrow.restore_held, "held")

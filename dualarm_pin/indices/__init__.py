"""What is minimised along the path: functions phi(A, u) of A = Wt^(1/2) J_r W J_r^T Wt^(1/2).

An index is written once, as plain functions of small arrays: Pinocchio's side calls them as they
are and the engine compiles them. Smaller is better for every index. Distance to the joint centres
comes on top of any of them: `force().with_joint_centre(0.1)`.
"""

from collections.abc import Callable

from dualarm_pin.indices.checks import DerivativeReport, check_derivatives
from dualarm_pin.indices.custom import custom
from dualarm_pin.indices.index import Index
from dualarm_pin.indices.spectral import (
    inverse_condition_number,
    smallest_singular_value,
    yoshikawa,
)
from dualarm_pin.indices.transmission import force, torque, velocity

INDICES: dict[str, Callable[..., Index]] = {
    factory.__name__: factory
    for factory in (
        force,
        torque,
        velocity,
        yoshikawa,
        inverse_condition_number,
        smallest_singular_value,
    )
}
"""The indices that task files name; a new one is a factory in a file of its own, and an entry."""

__all__ = [
    "INDICES",
    "DerivativeReport",
    "Index",
    "check_derivatives",
    "custom",
    "force",
    "inverse_condition_number",
    "smallest_singular_value",
    "torque",
    "velocity",
    "yoshikawa",
]

"""The three verbs: plan the whole path, in the paper's two stages, or locally.

Each returns a `Trajectory` that was checked with Pinocchio on the full path.
"""

from dualarm_pin.planners.local import plan_local
from dualarm_pin.planners.two_stage import plan_two_stage
from dualarm_pin.planners.whole_path import plan_global, polish

__all__ = ["plan_global", "plan_local", "plan_two_stage", "polish"]

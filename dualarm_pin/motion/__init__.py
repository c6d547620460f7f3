"""Motion: a path of postures becomes joint motion in time, within what the joints can do."""

from dualarm_pin.motion.record import Motion

__all__ = ["Motion"]

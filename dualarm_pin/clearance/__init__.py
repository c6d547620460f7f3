"""Clearance: how far apart bodies must stay, at the points of a path and between them."""

from dualarm_pin.clearance.rule import ClearanceRule

__all__ = ["ClearanceRule"]

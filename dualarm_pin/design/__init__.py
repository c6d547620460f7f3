"""Design a cell live: the best known motion follows while something is moved."""

from dualarm_pin.design.session import Answer, Session

__all__ = ["Answer", "Session"]

"""Design a cell live: the best known motion follows while something is moved."""

from dualarm_pin.design.answer import Answer
from dualarm_pin.design.session import Session

__all__ = ["Answer", "Session"]

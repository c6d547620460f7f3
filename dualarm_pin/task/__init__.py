"""Task: what is asked, in Python or in a file."""

from dualarm_pin.task.task import Task

__all__ = ["Task"]

"""Plan the joint motion of two arms that share one task, best over the whole path."""

__version__ = "0.1.0"

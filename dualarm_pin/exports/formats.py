"""The formats of `export`, in the order of the care that went into them."""

from __future__ import annotations

from dualarm_pin.errors import UnknownNameError, nearest
from dualarm_pin.exports.csv_table import CSV
from dualarm_pin.exports.fanuc import FANUC
from dualarm_pin.exports.format import Format
from dualarm_pin.exports.krl import KRL
from dualarm_pin.exports.moveit import MOVEIT
from dualarm_pin.exports.pdl2 import PDL2
from dualarm_pin.exports.rapid import RAPID
from dualarm_pin.exports.ros2 import ROS2
from dualarm_pin.exports.urscript import URSCRIPT

FORMATS = {each.name: each for each in (ROS2, MOVEIT, RAPID, FANUC, KRL, URSCRIPT, PDL2, CSV)}
SCENE = "glb"
"""A picture of the cell, in motion or not: no program, so no `Format`."""


def format_of(name: str | Format) -> Format:
    """Return a format by its name, or one of the user's own as it is.

    Raises:
        UnknownNameError: There is none of that name.
    """
    if isinstance(name, Format):
        return name
    if name not in FORMATS:
        names = [*FORMATS, SCENE]
        hint = nearest(name, names, len(names))
        known = "" if hint.startswith("known") else f" Known: {', '.join(names)}"
        raise UnknownNameError(f"no format {name!r}: {hint}{known}", field="--to")
    return FORMATS[name]

"""Every way to make a `Path`: curves from a few numbers, and files of points.

A new one is a function in a file of its own, and an entry here; what a task file may say about it
follows from its signature.
"""

from __future__ import annotations

from collections.abc import Callable

from dualarm_pin.path.files.apt import read_apt
from dualarm_pin.path.files.csv_file import read_csv
from dualarm_pin.path.files.gcode import read_gcode
from dualarm_pin.path.generators.planar import arc, circle, corner, raster
from dualarm_pin.path.generators.polyline import polyline
from dualarm_pin.path.generators.spatial import helix, spline
from dualarm_pin.path.generators.surface import dome_spiral, tube_seam
from dualarm_pin.path.generators.waves import figure_eight, sine
from dualarm_pin.path.path import Path

__all__ = [  # noqa: RUF022 - in the order in which messages list them
    "corner",
    "polyline",
    "circle",
    "arc",
    "helix",
    "raster",
    "sine",
    "figure_eight",
    "dome_spiral",
    "tube_seam",
    "spline",
    "read_csv",
    "read_gcode",
    "read_apt",
]

GENERATORS: dict[str, Callable[..., Path]] = {
    name.removeprefix("read_"): globals()[name] for name in __all__
}
"""Every generator by its name in task files."""


def __dir__() -> list[str]:
    return __all__

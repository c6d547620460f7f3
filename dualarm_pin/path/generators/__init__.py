"""Generators: functions that return a `Path` from a few numbers."""

from dualarm_pin.path.generators.planar import arc, circle, corner, raster
from dualarm_pin.path.generators.polyline import polyline
from dualarm_pin.path.generators.spatial import helix, spline
from dualarm_pin.path.generators.surface import dome_spiral, tube_seam
from dualarm_pin.path.generators.waves import figure_eight, sine

__all__ = [
    "arc",
    "circle",
    "corner",
    "dome_spiral",
    "figure_eight",
    "helix",
    "polyline",
    "raster",
    "sine",
    "spline",
    "tube_seam",
]

"""Generators: functions that return a `Path`; and paths from files."""

from dualarm_pin.paths.load import load_path
from dualarm_pin.paths.planar import arc_path, circle, corner, figure_eight, raster, sine
from dualarm_pin.paths.polyline import polyline
from dualarm_pin.paths.spatial import helix, spline
from dualarm_pin.paths.surface import dome_spiral, tube_seam

__all__ = [
    "arc_path",
    "circle",
    "corner",
    "dome_spiral",
    "figure_eight",
    "helix",
    "load_path",
    "polyline",
    "raster",
    "sine",
    "spline",
    "tube_seam",
]

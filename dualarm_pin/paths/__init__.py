"""Generators: functions that return a `Path`; paths from files; the points of the first stage."""

from dualarm_pin.paths.apt import read_apt
from dualarm_pin.paths.csv_file import read_csv
from dualarm_pin.paths.gamma import choose_Gamma
from dualarm_pin.paths.gcode import read_gcode
from dualarm_pin.paths.load import load_path
from dualarm_pin.paths.planar import arc, circle, corner, raster
from dualarm_pin.paths.polyline import polyline
from dualarm_pin.paths.resample import resample
from dualarm_pin.paths.spatial import helix, spline
from dualarm_pin.paths.surface import dome_spiral, tube_seam
from dualarm_pin.paths.waves import figure_eight, sine

__all__ = [
    "arc",
    "choose_Gamma",
    "circle",
    "corner",
    "dome_spiral",
    "figure_eight",
    "helix",
    "load_path",
    "polyline",
    "raster",
    "read_apt",
    "read_csv",
    "read_gcode",
    "resample",
    "sine",
    "spline",
    "tube_seam",
]

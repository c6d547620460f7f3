"""Paths from files: points as CSV, machine programs as G-code and APT."""

from dualarm_pin.path.files.apt import read_apt
from dualarm_pin.path.files.csv_file import read_csv
from dualarm_pin.path.files.gcode import read_gcode

__all__ = ["read_apt", "read_csv", "read_gcode"]

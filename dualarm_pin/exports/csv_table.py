"""A table for anything else: time, joints, velocities and accelerations, in rad, m and s.

Every sample of the motion is in it. Between rows lie polynomials of degree 5.
"""

from __future__ import annotations

import csv
import io

import numpy as np

from dualarm_pin.exports.format import Chord, Files, Format
from dualarm_pin.exports.program import Points, Program

FILE = "motion.csv"
_DIGITS = 12  # significant: what rounding leaves is far below any tolerance


def _write(program: Program) -> Files:
    text = io.StringIO()
    text.writelines(f"# {line}\n" for line in program.comment)
    # What ends a line inside a name is not quoted by itself.
    ends = any("\r" in joint for joint in program.joints)
    writer = csv.writer(text, "unix" if ends else "excel", lineterminator="\n")
    kinds = ("", "velocity ", "acceleration ")
    writer.writerow(["time", *(kind + joint for kind in kinds for joint in program.joints)])
    points = program.points
    assert points.velocity is not None
    assert points.acceleration is not None
    table = np.hstack([program.time[:, None], points.values, points.velocity, points.acceleration])
    writer.writerows([f"{value:.{_DIGITS}g}" for value in row] for row in table.tolist())
    return {FILE: text.getvalue()}


def _read(files: Files) -> Points:
    lines = io.StringIO(files[FILE], newline="")
    while (place := lines.tell(), lines.readline())[1].startswith("#"):
        pass
    lines.seek(place)
    header, *rows = csv.reader(lines)
    table = np.array(rows, dtype=float)
    n = (len(header) - 1) // 3
    if table.shape[1] != 3 * n + 1:
        raise ValueError("a row has another length than the header")
    return Points(table[:, 1 : n + 1], table[:, 0], table[:, n + 1 : 2 * n + 1], table[:, -n:])


CSV = Format(
    "csv", _write, _read, between="quintic", tolerance=Chord(0.01, 0.001), every_sample=True
)

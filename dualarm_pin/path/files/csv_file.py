"""Paths from CSV files: a header, then one pose a line."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Unpack

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.path.files.machine_program import read_text
from dualarm_pin.path.generators.curve import Samples
from dualarm_pin.path.generators.follow import Hold, hold
from dualarm_pin.path.path import Path, coincident, repeated
from dualarm_pin.path.resample import resample
from dualarm_pin.tolerance import TOLERANCE

_POSITION = ("x", "y", "z")
_QUATERNION = ("qw", "qx", "qy", "qz")
_DIRECTION = ("ux", "uy", "uz", "uwx", "uwy", "uwz")
_COLUMNS = (*_POSITION, *_QUATERNION, *_DIRECTION)


def read_csv(
    file: str | FilePath,
    *,
    points: int | None = None,
    step: float | None = None,
    smooth: bool = False,
    **how: Unpack[Hold],
) -> Path:
    """Return the path of a CSV file.

    Columns: x, y, z [m] of e2 in e1; qw, qx, qy, qz, its rotation; optional ux, uy, uz and with
    them uwx, uwy, uwz, the direction u in e1 axes. Without the quaternion `rotation` and
    `orientation` hold, as for every curve. Empty lines and lines that start with # are skipped.

    Args:
        file: The file, such as `path.csv`.
        points: Resample to so many points, such as `61`; or
        step: resample with this largest distance [m], such as `0.005`. With neither the points stay
            as they are.
        smooth: The curve between the points is a cubic spline instead of straight lines.
        **how: See `Hold`.

    Raises:
        MissingFileError: There is no such file.
        InputError: A column is missing or unknown, a value is not a finite number, a quaternion has
            no length or not unit length, or there are fewer than 2 points; names file and line.
    """
    table = _read(file)
    for key in ("rotation", "orientation"):
        if "qw" in table.header and key in how:
            message = f"the file gives the rotation (column qw): leave out `{key}`"
            raise InputError(message, file=file, line=1)
    rotation, u = _rotations(table), _directions(table)
    given = _given(table, rotation, u)
    if smooth or points is not None or step is not None:
        for i in repeated(given.position)[:1]:
            spot = f"the tool turns on the spot since line {table.lines[i]}"
            raise table.error(f"{spot}: such a path is not resampled", i + 1)
        given = resample(given, points=points, step=step, smooth=smooth)
    return hold(
        Samples(given.position, given.tangent, given.arc_length, None),
        FilePath(file).stem,
        how,
        rotation=None if rotation is None else given.rotation,
        u=None if u is None else given.u,
    )


@dataclass
class _Table:
    """What a CSV file holds: the line of each row, and the numbers (k, columns)."""

    file: str | FilePath
    header: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)

    def error(self, message: str, row: int, field: str | None = None) -> InputError:
        return InputError(message, file=self.file, line=self.lines[row], field=field)

    def take(self, names: Sequence[str]) -> Array:
        return np.array(self.rows)[:, [self.header.index(name) for name in names]]


def _given(table: _Table, rotation: Array | None, u: Array | None) -> Path:
    """Return the path as the file has it, with any rotation where it has none."""
    position = table.take(_POSITION)
    R = np.broadcast_to(np.eye(3), (len(position), 3, 3)) if rotation is None else rotation
    for i in coincident(position, R)[:1]:
        raise table.error(f"the same point as in line {table.lines[i]}: remove one of them", i + 1)
    try:
        return Path(position, R, u=u)
    except InputError as error:
        raise InputError(error.message, file=table.file, field=error.field) from error


def _read(file: str | FilePath) -> _Table:
    table = _Table(file)
    for number, cells in _rows(file):
        if table.header:
            table.lines.append(number)
            table.rows.append(_numbers(cells, table))
        else:
            _check_header(cells, file, number)
            table.header = cells
    if not table.header:
        message = f"the file is empty: a header is expected, such as {','.join(_COLUMNS[:7])}"
        raise InputError(message, file=file)
    if len(table.rows) < 2:
        message = f"a path needs 2 points or more; given {len(table.rows)}"
        raise InputError(message, file=file, line=table.lines[-1] if table.lines else None)
    return table


def _rows(file: str | FilePath) -> Iterator[tuple[int, list[str]]]:
    """Yield the line and the cells of each row that says something."""
    reader = csv.reader(read_text(file).splitlines())
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells) and not cells[0].startswith("#"):
                yield reader.line_num, cells
    except csv.Error as error:
        message = f"not a CSV file: {error}"
        raise InputError(message, file=file, line=reader.line_num) from error


def _check_header(header: list[str], file: str | FilePath, line: int) -> None:
    for k, name in enumerate(header):
        if name not in _COLUMNS:
            known = nearest(name, _COLUMNS, limit=len(_COLUMNS))
            message = f"unknown column {name!r}: {known}; columns are separated by commas"
            raise InputError(message, file=file, line=line)
        if name in header[:k]:
            raise InputError(f"the column {name} is given twice", file=file, line=line)
    for group in (_POSITION, _QUATERNION, _DIRECTION[:3], _DIRECTION[3:]):
        missing = [name for name in group if name not in header]
        if missing and (group is _POSITION or len(missing) < len(group)):
            message = f"missing column {', '.join(missing)}: {', '.join(group)} belong together"
            raise InputError(message, file=file, line=line)
    if "uwx" in header and "ux" not in header:
        message = "missing column ux, uy, uz: uwx, uwy, uwz are its angular part"
        raise InputError(message, file=file, line=line)


def _numbers(cells: list[str], table: _Table) -> list[float]:
    expected = len(table.header)
    if len(cells) != expected:
        message = f"{expected} values are expected, as in the header; given {len(cells)}"
        raise table.error(message, -1)
    numbers = []
    for name, cell in zip(table.header, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise table.error(f"a finite number is expected; given {cell!r}", -1, name)
        numbers.append(number)
    return numbers


def _rotations(table: _Table) -> Array | None:
    """Return the rotations, shape (k, 3, 3), if the file has any."""
    if "qw" not in table.header:
        return None
    quaternion = table.take(_QUATERNION)
    length = np.linalg.norm(quaternion, axis=1)
    for i in np.flatnonzero(np.abs(length - 1.0) > TOLERANCE.unit)[:1]:
        message = f"the quaternion has length {length[i]:.6g}, and 1 is expected"
        raise table.error(message, i, "qw")
    return np.array([pin.Quaternion(*(q / np.linalg.norm(q))).matrix() for q in quaternion])


def _directions(table: _Table) -> Array | None:
    """Return the directions, shape (k, 6), if the file has any."""
    if "ux" not in table.header:
        return None
    u = table.take(_DIRECTION if "uwx" in table.header else _DIRECTION[:3])
    for i in np.flatnonzero(np.linalg.norm(u, axis=1) < 1e-12)[:1]:
        raise table.error("the direction is zero: give one at every point", i, "ux")
    return u

"""Paths from CSV files: a header, then one pose a line."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from pathlib import Path as FilePath
from typing import Unpack

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.path.files.machine_program import read_text
from dualarm_pin.path.generators.curve import Samples
from dualarm_pin.path.generators.follow import Hold, hold
from dualarm_pin.path.path import Path, coincident
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
        file: The file.
        points: Resample to so many points; or
        step: resample with this largest distance [m]. With neither the points stay as they are.
        smooth: The curve between the points is a cubic spline instead of straight lines.
        **how: See `Hold`.

    Raises:
        MissingFileError: There is no such file.
        InputError: A column is missing or unknown, a value is not a finite number, a quaternion has
            no length or not unit length, or there are fewer than 2 points; names file and line.
    """
    columns, lines = _read(file)
    position = _take(columns, _POSITION)
    if "qw" in columns:
        for key in ("rotation", "orientation"):
            if key in how:
                message = f"the file gives the rotation (column qw): leave out `{key}`"
                raise InputError(message, file=file, line=1)
    rotation = _rotations(columns, file, lines)
    u = _directions(columns, file, lines)
    given = _given(position, rotation, u, file, lines)
    if smooth or points is not None or step is not None:
        _refuse_turning(position, file, lines)
        given = resample(given, points=points, step=step, smooth=smooth)
    return hold(
        Samples(given.position, given.tangent, given.arc_length, None),
        FilePath(file).stem,
        how,
        rotation=None if rotation is None else given.rotation,
        u=None if u is None else given.u,
    )


def _given(
    position: Array,
    rotation: Array | None,
    u: Array | None,
    file: str | FilePath,
    lines: list[int],
) -> Path:
    """Return the path as the file has it, with any rotation where it has none."""
    R = np.broadcast_to(np.eye(3), (len(position), 3, 3)) if rotation is None else rotation
    for i in coincident(position, R)[:1]:
        message = f"the same point as in line {lines[i]}: remove one of them"
        raise InputError(message, file=file, line=lines[i + 1])
    try:
        return Path(position, R, u=u)
    except InputError as error:
        raise InputError(error.message, file=file, field=error.field) from error


def _read(file: str | FilePath) -> tuple[dict[str, Array], list[int]]:
    """Return the columns, and the line of each point."""
    header: list[str] = []
    values: list[list[float]] = []
    lines: list[int] = []
    for number, cells in _rows(file):
        if header:
            values.append(_numbers(cells, header, file, number))
            lines.append(number)
        else:
            _check_header(cells, file, number)
            header = cells
    if not header:
        message = f"the file is empty: a header is expected, such as {','.join(_COLUMNS[:7])}"
        raise InputError(message, file=file)
    if len(values) < 2:
        message = f"a path needs 2 points or more; given {len(values)}"
        raise InputError(message, file=file, line=lines[-1] if lines else None)
    table = np.array(values)
    return {name: table[:, k] for k, name in enumerate(header)}, lines


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


def _check_header(header: list[str], file: str | FilePath, line_number: int) -> None:
    for k, name in enumerate(header):
        if name not in _COLUMNS:
            known = nearest(name, _COLUMNS, limit=len(_COLUMNS))
            message = f"unknown column {name!r}: {known}; columns are separated by commas"
            raise InputError(message, file=file, line=line_number)
        if name in header[:k]:
            raise InputError(f"the column {name} is given twice", file=file, line=line_number)
    for group in (_POSITION, _QUATERNION, _DIRECTION[:3], _DIRECTION[3:]):
        needed = group is _POSITION or any(name in header for name in group)
        missing = [name for name in group if name not in header]
        if needed and missing:
            message = f"missing column {', '.join(missing)}: {', '.join(group)} belong together"
            raise InputError(message, file=file, line=line_number)
    if "uwx" in header and "ux" not in header:
        message = "missing column ux, uy, uz: uwx, uwy, uwz are its angular part"
        raise InputError(message, file=file, line=line_number)


def _numbers(
    cells: list[str], header: list[str], file: str | FilePath, line_number: int
) -> list[float]:
    if len(cells) != len(header):
        message = f"{len(header)} values are expected, as in the header; given {len(cells)}"
        raise InputError(message, file=file, line=line_number)
    numbers = []
    for name, cell in zip(header, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            message = f"a finite number is expected; given {cell!r}"
            raise InputError(message, file=file, line=line_number, field=name)
        numbers.append(number)
    return numbers


def _take(columns: dict[str, Array], names: Sequence[str]) -> Array:
    return np.column_stack([columns[name] for name in names])


def _rotations(columns: dict[str, Array], file: str | FilePath, lines: list[int]) -> Array | None:
    """Return the rotations, shape (k, 3, 3), if the file has any."""
    if "qw" not in columns:
        return None
    quaternion = _take(columns, _QUATERNION)
    length = np.linalg.norm(quaternion, axis=1)
    for i in np.flatnonzero(np.abs(length - 1.0) > TOLERANCE.unit)[:1]:
        message = f"the quaternion has length {length[i]:.6g}, and 1 is expected"
        raise InputError(message, file=file, line=lines[i], field="qw")
    return np.array([pin.Quaternion(*(q / np.linalg.norm(q))).matrix() for q in quaternion])


def _directions(columns: dict[str, Array], file: str | FilePath, lines: list[int]) -> Array | None:
    """Return the directions, shape (k, 6), if the file has any."""
    if "ux" not in columns:
        return None
    linear = _take(columns, _DIRECTION[:3])
    angular = _take(columns, _DIRECTION[3:]) if "uwx" in columns else np.zeros_like(linear)
    u = np.hstack([linear, angular])
    for i in np.flatnonzero(np.linalg.norm(u, axis=1) < 1e-12)[:1]:
        message = "the direction is zero: give one at every point"
        raise InputError(message, file=file, line=lines[i], field="ux")
    return u


def _refuse_turning(position: Array, file: str | FilePath, lines: list[int]) -> None:
    apart = np.linalg.norm(np.diff(position, axis=0), axis=1) > TOLERANCE.coincident
    for i in np.flatnonzero(~apart)[:1]:
        message = f"the tool turns on the spot since line {lines[i]}: such a path is not resampled"
        raise InputError(message, file=file, line=lines[i + 1])

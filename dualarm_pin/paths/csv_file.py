"""Paths from CSV files: a header, then one pose a line."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Sequence
from pathlib import Path as FilePath
from typing import Unpack

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.path import Path, coincident
from dualarm_pin.paths.curve import Piece, as_given, at_arc_length, line, sample
from dualarm_pin.paths.follow import Hold, hold
from dualarm_pin.paths.moves import read_text
from dualarm_pin.paths.spatial import spline_pieces
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
    still = np.broadcast_to(np.eye(3), (len(position), 3, 3))
    for i in coincident(position, still if rotation is None else rotation)[:1]:
        message = f"the same point as in line {lines[i]}: remove one of them"
        raise InputError(message, file=file, line=lines[i + 1])
    if smooth or points is not None or step is not None:
        pieces = _pieces(position, smooth, file, lines)
        knots = np.concatenate([[0.0], np.cumsum([piece.length for piece in pieces])])
        if points is None and step is None:
            samples = at_arc_length(pieces, knots)
        else:
            samples = sample(pieces, points=points, step=step)
            rotation = None if rotation is None else _turned(rotation, knots, samples.arc_length)
            u = None if u is None else _between(u, knots, samples.arc_length)
    else:
        samples = as_given(position)
    return hold(samples, FilePath(file).stem, how, rotation=rotation, u=u)


def _read(file: str | FilePath) -> tuple[dict[str, Array], list[int]]:
    """Return the columns, and the line of each point."""
    header: list[str] = []
    values: list[list[float]] = []
    lines: list[int] = []
    reader = csv.reader(read_text(file).splitlines())
    for row in reader:
        cells = [cell.strip() for cell in row]
        if not any(cells) or cells[0].startswith("#"):
            continue
        if not header:
            header = cells
            _check_header(header, file, reader.line_num)
            continue
        values.append(_numbers(cells, header, file, reader.line_num))
        lines.append(reader.line_num)
    if not header:
        message = f"the file is empty: a header is expected, such as {','.join(_COLUMNS[:7])}"
        raise InputError(message, file=file)
    if len(values) < 2:
        message = f"a path needs 2 points or more; given {len(values)}"
        raise InputError(message, file=file, line=reader.line_num)
    table = np.array(values)
    return {name: table[:, k] for k, name in enumerate(header)}, lines


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


def _pieces(position: Array, smooth: bool, file: str | FilePath, lines: list[int]) -> list[Piece]:
    apart = np.linalg.norm(np.diff(position, axis=0), axis=1) > TOLERANCE.coincident
    for i in np.flatnonzero(~apart)[:1]:
        message = f"the tool turns on the spot since line {lines[i]}: such a path is not resampled"
        raise InputError(message, file=file, line=lines[i + 1])
    if smooth:
        return spline_pieces(position, "position")
    return [line(start, stop) for start, stop in itertools.pairwise(position)]


def _turned(rotation: Array, knots: Array, s: Array) -> Array:
    """Return the rotations between the given ones, by the shortest turn, at arc lengths `s`."""
    from scipy.spatial.transform import Rotation, Slerp

    between = Slerp(knots, Rotation.from_matrix(rotation))
    return np.asarray(between(np.clip(s, 0.0, knots[-1])).as_matrix())


def _between(u: Array, knots: Array, s: Array) -> Array:
    """Return the directions between the given ones, with the lengths between theirs."""
    return np.column_stack([np.interp(s, knots, column) for column in u.T])

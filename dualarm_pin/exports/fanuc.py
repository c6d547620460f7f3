"""FANUC TP program (LS): both motion groups in one point, so both arrive together.

The third axis of the controller is counted from the horizontal: J3 = J3 - J2 of the kinematics.
"""

from __future__ import annotations

import re

import numpy as np

from dualarm_pin.exports.format import Axes, Files, Format
from dualarm_pin.exports.names import comment, identifier
from dualarm_pin.exports.program import Points, Program

_BASE, _WITH_PARTS = 8, 5  # letters of a name; of one that a number follows
_LINES = 9900  # in one program: longer ones are split at 9999 lines
_REMARK = 30  # letters of a remark; the controller takes 32
_MOVE = re.compile(r"^ *\d+:J P\[(\d+)\] (?:10%|(\d+)msec) (?:FINE|CNT100) ;$", re.MULTILINE)
_CALL = re.compile(r"^ *\d+:CALL (\w+) ;$", re.MULTILINE)
_POINT = re.compile(r"^P\[(\d+)\]\{\n(.*?)^\};$", re.MULTILINE | re.DOTALL)
_AXIS = re.compile(r"J(\d) = (-?[\d.]+) deg")


def _write(program: Program) -> Files:
    pieces = program.pieces(_LINES)
    remarks = [f"!{part}" for line in program.comment for part in comment(line, _REMARK)]
    if len(pieces) == 1:
        name = identifier(program.name, _BASE).upper()
        return {f"{name}.ls": _program(program, name, remarks, pieces[0])}
    base = identifier(program.name, _WITH_PARTS).upper()
    names = [f"{base}_{k}" for k in range(1, len(pieces) + 1)]
    main = _text(program, base, [*remarks, *(f"CALL {name}" for name in names)], [])
    parts = zip(names, pieces, strict=True)
    return {f"{base}.ls": main} | {
        f"{name}.ls": _program(program, name, [], piece) for name, piece in parts
    }


def _program(program: Program, name: str, remarks: list[str], piece: range) -> str:
    # Whole milliseconds since the start: what is rounded away never adds up.
    spans = np.diff(np.rint(1000.0 * program.time).astype(int), prepend=0)
    last, moves = len(program.points) - 1, []
    for number, i in enumerate(piece, 1):
        speed = f"{max(1, spans[i])}msec" if i else "10%"
        moves.append(f"J P[{number}] {speed} {'CNT100' if 0 < i < last else 'FINE'}")
    points = [_point(program, number, i) for number, i in enumerate(piece, 1)]
    return _text(program, name, [*remarks, *moves], points)


def _text(program: Program, name: str, lines: list[str], points: list[str]) -> str:
    groups = ",".join("1" if k < len(program.arms) else "*" for k in range(5))
    body = [f"{number:4d}:{line} ;" for number, line in enumerate(lines, 1)]
    head = [f"/PROG  {name}", "/ATTR", 'COMMENT = "dualarm_pin";', f"DEFAULT_GROUP = {groups};"]
    return "\n".join([*head, "/MN", *body, "/POS", *points, "/END", ""])


def _point(program: Program, number: int, i: int) -> str:
    groups = []
    for group, part in enumerate(program.arms.values(), 1):
        values = program.points.values[i, part].tolist()
        axes = [f"J{k} = {value + 0.0:.5f} deg" for k, value in enumerate(values, 1)]
        rows = ",\n".join(f"    {', '.join(axes[k : k + 3])}" for k in range(0, len(axes), 3))
        groups.append(f"   GP{group}:\n    UF : 0, UT : 1,\n{rows}")
    return f"P[{number}]{{\n" + "\n".join(groups) + "\n};"


def _read(files: Files) -> Points:
    called = {name for text in files.values() for name in _CALL.findall(text)}
    [main] = [name for name in files if name.removesuffix(".ls") not in called]
    parts = [files[f"{name}.ls"] for name in _CALL.findall(files[main])] or [files[main]]
    rows, spans = [], []
    for text in parts:
        point = {number: body for number, body in _POINT.findall(text)}
        if len(found := _MOVE.findall(text)) != text.count(":J P["):
            raise ValueError("a move cannot be read")
        for number, span in found:
            axes = _AXIS.findall(point[number])
            if [int(axis) for axis, _ in axes] != [k % 6 + 1 for k in range(len(axes))]:
                raise ValueError(f"the axes of P[{number}] cannot be read")
            rows.append([float(value) for _, value in axes])
            spans.append(float(span or 0.0) / 1000.0)
    return Points(np.array(rows), np.cumsum(spans))


FANUC = Format(
    "fanuc",
    _write,
    _read,
    axes=Axes(6, "deg", coupling=((2, 1, -1.0),)),
    draft=("Angles have five decimals; programs saved by controllers show three.",),
)

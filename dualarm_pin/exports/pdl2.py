"""Comau PDL2: one program, both arms in one move. A draft: SYNCMOVE stands in no source we read."""

from __future__ import annotations

import re

import numpy as np

from dualarm_pin.exports.format import Axes, Files, Format
from dualarm_pin.exports.names import identifier
from dualarm_pin.exports.program import Points, Program

_BASE = 20  # letters of the name
_LINES = 4900  # in one program: longer ones are split at 5000 lines
_VARIABLES = {"arm1": "a", "arm2": "b"}
_POINT = re.compile(r"^  JNT\(([ab]), ([^)]*)\)$", re.MULTILINE)
_CALL = re.compile(r"^  CALL (\w+)$", re.MULTILINE)


def _write(program: Program) -> Files:
    base = identifier(program.name, _BASE)
    pieces = program.pieces(_LINES // (len(program.arms) + 1))
    if len(pieces) == 1:
        return {f"{base}.pdl": _program(program, base, pieces[0], program.comment)}
    names = [f"{base}_p{k}" for k in range(1, len(pieces) + 1)]
    head = [f"PROGRAM {base} EZ, PROG_ARM = 1, STACK = 2048", *_comments(program.comment)]
    routines = [f"ROUTINE {name} EXPORTED FROM {name}" for name in names]
    main = [*head, *routines, "BEGIN", *(f"  CALL {name}" for name in names), f"END {base}", ""]
    return {f"{base}.pdl": "\n".join(main)} | {
        f"{name}.pdl": _program(program, name, piece, ())
        for name, piece in zip(names, pieces, strict=True)
    }


def _program(program: Program, name: str, piece: range, comment: tuple[str, ...]) -> str:
    arms = list(program.arms)
    rows = {arm: program.axes(arm) for arm in arms}
    moves = []
    for i in piece:
        for arm in arms:
            values = ", ".join(f"{value + 0.0:.5f}" for value in rows[arm][i])
            moves.append(f"  JNT({_VARIABLES[arm]}, {values})")
        moves.append(f"  {_move(arms)}")
    numbers = {arm: arm[-1] for arm in arms}
    variables = [f"{_VARIABLES[arm]} : JOINTPOS FOR ARM[{numbers[arm]}]" for arm in arms]
    lines = [
        f"PROGRAM {name} EZ, PROG_ARM = {numbers[arms[0]]}, STACK = 2048",
        *_comments(comment),
        *(f"{'VAR' if k == 0 else '   '} {each}" for k, each in enumerate(variables)),
        "BEGIN",
        *(f"  ATTACH ARM[{numbers[arm]}]" for arm in arms[1:]),
        "  $JNT_OVR := 20",
        *moves,
        f"END {name}",
        "",
    ]
    return "\n".join(lines)


def _comments(comment: tuple[str, ...]) -> list[str]:
    return [f"-- {line}" for line in comment]


def _move(arms: list[str]) -> str:
    first = f"MOVE JOINT TO {_VARIABLES[arms[0]]}"
    others = (f" SYNCMOVE ARM[{arm[-1]}] JOINT TO {_VARIABLES[arm]}" for arm in arms[1:])
    return first + "".join(others)


def _read(files: Files) -> Points:
    called = {name for text in files.values() for name in _CALL.findall(text)}
    [main] = [name for name in files if name.removesuffix(".pdl") not in called]
    names = [f"{name}.pdl" for name in _CALL.findall(files[main])] or [main]
    text = "".join(files[name] for name in names)
    found: dict[str, list[list[float]]] = {}
    for variable, values in _POINT.findall(text):
        found.setdefault(variable, []).append([float(value) for value in values.split(",")])
    moves = text.count("MOVE JOINT TO")
    if any(len(rows) != moves for rows in found.values()):
        raise ValueError("a move cannot be read")
    return Points(np.hstack([found[variable] for variable in sorted(found)]), None)


PDL2 = Format(
    "pdl2",
    _write,
    _read,
    axes=Axes(6, "deg"),
    draft=(
        "unverified: SYNCMOVE stands in no source that could be read. Try it in RoboSim first.",
        "The calls of programs in parts are unverified too.",
        "It knows no times: the speed is that of the override, 20 per cent.",
        "Signs and zeros of the axes are those of the URDF unless the cell file says otherwise.",
    ),
)

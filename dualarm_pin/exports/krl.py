"""KUKA KRL: one program for each controller; a spline block of a stated time keeps the pace."""

from __future__ import annotations

import re

import numpy as np

from dualarm_pin.exports.format import Axes, Files, Format
from dualarm_pin.exports.names import identifier
from dualarm_pin.exports.program import Points, Program

_BASE = 20  # letters of the name; 24 with what is added
_ROBOTS = {"arm1": "R1", "arm2": "R2"}
_AXES = ", ".join(rf"A{k} (-?[\d.]+)" for k in range(1, 7))
_MOVE = re.compile(rf"^ *(?:PTP|SPTP) \{{{_AXES}\}}$", re.MULTILINE)
_PART = re.compile(r"^ *TIME_BLOCK PART = ([\d.]+)$", re.MULTILINE)
_END = re.compile(r"^ *TIME_BLOCK END = ([\d.]+)$", re.MULTILINE)


def _write(program: Program) -> Files:
    base = identifier(program.name, _BASE)
    return {
        f"{base}_{robot}.src": _program(program, f"{base}_{robot}", arm)
        for arm, robot in _ROBOTS.items()
        if arm in program.arms
    }


def _program(program: Program, name: str, arm: str) -> str:
    first, *moves = [
        ", ".join(f"A{k} {value + 0.0:.4f}" for k, value in enumerate(row, 1))
        for row in program.axes(arm)
    ]
    duration = float(program.time[-1])
    parts = 100.0 * np.diff(program.time) / duration
    lines = [f"  SPTP {{{first}}}", "  TIME_BLOCK START"]
    for move, part in zip(moves, parts.tolist(), strict=True):
        lines += [f"  SPTP {{{move}}}", f"  TIME_BLOCK PART = {part:.6f}"]
    lines.append(f"  TIME_BLOCK END = {duration:.4f}")
    wait = ['SYNCCMD(#ProgSync, "A1", 3)'] if len(program.arms) > 1 else []
    head = ["&ACCESS RVP", "&REL 1", f"DEF {name}()", *(f"; {line}" for line in program.comment)]
    start = ["BAS(#INITMOV,0)", f"PTP {{{first}}}", *wait, "PTP_SPLINE"]
    return "\n".join([*head, *start, *lines, "ENDSPLINE", "END", ""])


def _read(files: Files) -> Points:
    arms, times = [], []
    for robot in _ROBOTS.values():
        for name in (name for name in files if name.endswith(f"_{robot}.src")):
            text = files[name]
            found = _MOVE.findall(text)
            if len(found) != text.count("PTP {"):
                raise ValueError(f"{name}: a move cannot be read")
            rows = [[float(axis) for axis in move] for move in found]
            arms.append(rows[1:])  # the block begins where the approach ends
            part = np.array([float(share) for share in _PART.findall(text)])
            [end] = _END.findall(text)
            times.append(np.concatenate([[0.0], np.cumsum(part / part.sum() * float(end))]))
    return Points(np.hstack(arms), times[0])


KRL = Format(
    "krl",
    _write,
    _read,
    axes=Axes(6, "deg"),
    draft=(
        "TIME_BLOCK PART in per cent: one source writes per cent, another seconds.",
        "Two controllers begin together (SYNCCMD of RoboTeam) and then run on their own clocks.",
        "Between its points PTP_SPLINE is smooth; the error stated is that of straight joints.",
    ),
)

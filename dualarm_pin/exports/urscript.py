"""Universal Robots URScript: one script for each robot, joints streamed at equal times."""

from __future__ import annotations

import re

import numpy as np

from dualarm_pin.exports.format import Axes, Files, Format
from dualarm_pin.exports.names import identifier
from dualarm_pin.exports.program import Points, Program

_BASE = 40  # letters of the name
_PERIOD = 0.002  # a control cycle at 500 Hz [s]
_ROBOTS = {"arm1": "r1", "arm2": "r2"}
_STREAM = re.compile(
    r"^  servoj\(\[(.*?)\], t=([\d.]+), lookahead_time=0.1, gain=300\)$", re.MULTILINE
)


def _write(program: Program) -> Files:
    base = identifier(program.name, _BASE)
    return {
        f"{base}_{robot}.script": _script(program, f"{base}_{robot}", arm)
        for arm, robot in _ROBOTS.items()
        if arm in program.arms
    }


def _script(program: Program, name: str, arm: str) -> str:
    rows = [", ".join(f"{value + 0.0:.8f}" for value in row) for row in program.axes(arm)]
    wait = ["  while get_standard_digital_in(0) == False:", "    sync()", "  end"]
    lines = [
        f"def {name}():",
        *(f"  # {line}" for line in program.comment),
        f"  movej([{rows[0]}], a=0.5, v=0.2)",
        *(wait if len(program.arms) > 1 else []),
        *(f"  servoj([{row}], t={_PERIOD}, lookahead_time=0.1, gain=300)" for row in rows),
        "  stopj(2.0)",
        "end",
        "",
    ]
    return "\n".join(lines)


def _read(files: Files) -> Points:
    arms, times = [], []
    for robot in _ROBOTS.values():
        for name in (name for name in files if name.endswith(f"_{robot}.script")):
            found = _STREAM.findall(files[name])
            if len(found) != files[name].count("servoj("):
                raise ValueError(f"{name}: a line cannot be read")
            arms.append([[float(value) for value in row.split(",")] for row, _ in found])
            times.append(np.cumsum([0.0, *(float(step) for _, step in found[1:])]))
    return Points(np.hstack(arms), times[0])


URSCRIPT = Format(
    "urscript",
    _write,
    _read,
    axes=Axes(6, "rad"),
    period=_PERIOD,
    draft=(
        "Two robots begin together when input 0 of both rises; then each runs on its own clock.",
        "get_standard_digital_in was written from memory. servoj lags by about its lookahead_time.",
        "CB3 controllers stream at 125 Hz: this file is for 500 Hz.",
    ),
)

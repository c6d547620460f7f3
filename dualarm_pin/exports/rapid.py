"""ABB RAPID with MultiMove: one task for each robot, synchronised point by point.

Every move carries its time; between SyncMoveOn and SyncMoveOff the same identity in both tasks
makes the robots arrive together, the slower one setting the pace.
"""

from __future__ import annotations

import re

import numpy as np

from dualarm_pin.exports.format import Axes, Files, Format
from dualarm_pin.exports.names import identifier
from dualarm_pin.exports.program import Points, Program

_BASE = 18  # letters of the name given by the user; 32 with what is added
_MOVES = 4900  # in one module: programs are loaded in parts of 5000 lines
_TASKS = {"arm1": "T_ROB1", "arm2": "T_ROB2"}
_NO_AXES = "9E9,9E9,9E9,9E9,9E9,9E9"
_MOVE = re.compile(
    r"^  MoveAbsJ \[\[([^]]*)\],\[9E9(?:,9E9){5}\]\](?:\\ID:=(\d+))?\\NoEOffs,"
    r"(?:v100|vfeed(?:\\T:=([\d.]+))?),(?:fine|z1),tool0;$",
    re.MULTILINE,
)
_CALL = re.compile(r"^  \w+_(p\d+);$", re.MULTILINE)


def _write(program: Program) -> Files:
    base, files = identifier(program.name, _BASE), {}
    for arm in program.arms:
        name = f"{base}_{_TASKS[arm]}"
        approach, *moves = _moves(program, arm)
        pieces = program.pieces(_MOVES, start=1)
        if len(pieces) > 1:
            for k, piece in enumerate(pieces, 1):
                part = [f"PROC {base}_p{k}()", *moves[piece.start - 1 : piece.stop - 1], "ENDPROC"]
                module = [f"MODULE {base}_p{k}_m", *part, "ENDMODULE", ""]
                files[f"{name}_p{k}.mod"] = "\n".join(module)
            moves = [f"  {base}_p{k};" for k in range(1, len(pieces) + 1)]
        files[f"{name}.mod"] = _main(program, name, approach, moves)
    return files


def _main(program: Program, name: str, approach: str, moves: list[str]) -> str:
    tasks = ",".join(f'["{_TASKS[arm]}"]' for arm in program.arms)
    shared: list[str] = []
    if len(program.arms) > 1:
        shared = [
            f"PERS tasks all_tasks{{{len(program.arms)}}} := [{tasks}];",
            "VAR syncident sync1;",
            "VAR syncident sync2;",
        ]
        moves = ["  SyncMoveOn sync1, all_tasks;", *moves, "  SyncMoveOff sync2;"]
    lines = [
        f"MODULE {name}",
        *(f"! {line}" for line in program.comment),
        *shared,
        "TASK PERS speeddata vfeed := [100,500,5000,1000];",
        "PROC main()",
        approach,
        *moves,
        "ENDPROC",
        "ENDMODULE",
        "",
    ]
    return "\n".join(lines)


def _moves(program: Program, arm: str) -> list[str]:
    """Return a move to each point; the first approaches, slowly and alone."""
    last, together = len(program.points) - 1, len(program.arms) > 1
    spans = np.diff(program.time.round(5), prepend=0.0).tolist()
    lines = []
    for i, (row, span) in enumerate(zip(program.axes(arm), spans, strict=True)):
        target = f"[[{','.join(f'{value + 0.0:.5f}' for value in row)}],[{_NO_AXES}]]"
        identity = f"\\ID:={10 * i}" if i and together else ""
        speed = f"vfeed\\T:={span:.5f}" if i else "v100"
        zone = "z1" if 0 < i < last else "fine"
        lines.append(f"  MoveAbsJ {target}{identity}\\NoEOffs,{speed},{zone},tool0;")
    return lines


def _read(files: Files) -> Points:
    arms, times, identities = [], [], []
    for task in _TASKS.values():
        for main in (name for name in files if name.endswith(f"_{task}.mod")):
            text = files[main]
            for part in _CALL.findall(text):
                text += files[main.replace(".mod", f"_{part}.mod")]
            found = [match.groups() for match in _MOVE.finditer(text)]
            if len(found) != text.count("MoveAbsJ"):
                raise ValueError(f"{main}: a move cannot be read")
            arms.append([[float(value) for value in move[0].split(",")] for move in found])
            identities.append([move[1] for move in found])
            times.append(np.cumsum([0.0, *(float(move[2]) for move in found[1:])]))
    if any(other != identities[0] for other in identities):
        raise ValueError("the tasks do not wait for each other at the same moves")
    return Points(np.hstack(arms), times[0])


RAPID = Format(
    "rapid",
    _write,
    _read,
    axes=Axes(6, "deg"),
    draft=("T and ID in one move: the grammar allows it, no real program with both was seen.",),
)

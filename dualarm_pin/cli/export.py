"""`dualarm-pin export`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE, NOT_FOUND


def export(
    result: Path,
    /,
    *,
    to: str,
    out: Path,
    name: str | None = None,
    mm: float | None = None,
    deg: float | None = None,
    point: int | None = None,
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Write the motion of a result as a program or a scene, read it back and check it.

    Args:
        result: A result folder with a motion.
        to: ros2, moveit, rapid, fanuc, krl, urscript, pdl2 or csv: a program, for a controller; or
            glb: the cell in motion, for Blender, a browser or slides.
        out: Folder of the program; empty, or with an earlier program of the same names.
        name: Name of the program; that of the result folder by default.
        mm: Largest distance from the relative path in mm, of a scene from where a body belongs;
            that of the format by default.
        deg: Largest angle in degrees.
        point: Let the scene stand still at this point of the path, from 1; this needs no motion.
        allow_code: Import and run the index, path or rows that the task names with `call`.
    """
    from dualarm_pin.exports import export as write

    exported = write(result, to, out, name=name, mm=mm, deg=deg, point=point, allow_code=allow_code)
    print(exported.as_text())
    if exported.passed:
        print("written: " + ", ".join(str(out / file) for file in exported.files))
        return DONE
    print(
        "dualarm-pin: nothing is written: what was read back is off by more than is allowed; "
        "make the motion with finer samples, or allow more with --mm and --deg",
        file=sys.stderr,
    )
    return NOT_FOUND

"""`dualarm-pin new`."""

from __future__ import annotations

import sys
from pathlib import Path

from dualarm_pin.cli import DONE


def new(folder: Path, *urdf: str) -> int:
    """Write a commented cell and task to start from.

    Args:
        folder: Folder of the two files.
        urdf: URDF or xacro file of each arm, one for both; asked for if none is given.
    """
    from dualarm_pin.cell.describe import describe
    from dualarm_pin.cell.report_text import text_of
    from dualarm_pin.errors import InputError
    from dualarm_pin.starter import start_from

    urdfs = list(urdf)
    if not urdfs and sys.stdin.isatty():
        urdfs = [input("URDF of arm 1: "), input("URDF of arm 2 (empty: the same): ")]
    urdfs = [each.strip() for each in urdfs if each.strip()]
    if len(urdfs) not in (1, 2):
        raise InputError(f"one or two URDFs are expected; given {len(urdfs)}", field="URDF")
    made = start_from(urdfs, folder)
    files = made.write(folder)
    print(text_of(describe(made.cell)))
    print(f"written: {', '.join(map(str, files))}")
    if not made.reached:
        print("the circle may be out of reach: move arm2 in cell.yaml or the frame in task.yaml")
    print(f"next: dualarm-pin solve {files[-1]} --effort quick")
    return DONE

"""Expand xacro through xacrodoc, an extra; ROS itself is never needed, and no code is run."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dualarm_pin.errors import InputError, MissingExtraError
from dualarm_pin.robot.xacro_child import TOO_MUCH

SECONDS = 20  # of processor time; a robot with hundreds of macros takes one
MEMORY = 2 * 1024**3  # bytes, those of the libraries included
_WAIT = 300.0  # seconds: a process that waits spends none of its processor time
_LIMITS = (-signal.SIGXCPU, -signal.SIGKILL)  # how a process ends that passes them
# The child imports from where this process does: its folder may hold anything.
_CHILD = """\
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from dualarm_pin.robot.xacro_child import main
main()
"""


def expand_xacro(
    file: Path, arguments: Mapping[str, str | bool | float], package_dirs: Sequence[Path]
) -> bytes:
    """Return the URDF text that a xacro file expands to, in a process of its own.

    Args:
        file: The xacro file.
        arguments: Values of its `<xacro:arg>`.
        package_dirs: Folders that hold the packages it finds with `$(find ...)`.

    Raises:
        MissingExtraError: xacrodoc is not installed.
        InputError: The file cannot be expanded, or not in reasonable time and memory, or an
            expression in it is more than arithmetic.
    """
    if importlib.util.find_spec("xacrodoc") is None:
        raise MissingExtraError(
            f"{file}: xacro files need xacrodoc: pip install 'dualarm-pin[xacro]', or expand the "
            "file with `xacro in.xacro -o out.urdf`"
        )
    asked = {
        "file": str(file.absolute()),
        "arguments": {key: _text(value) for key, value in arguments.items()},
        "package_dirs": [str(folder.absolute()) for folder in package_dirs],
        "seconds": SECONDS,
        "memory": MEMORY,
    }
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", _CHILD, json.dumps([*map(os.path.abspath, sys.path)])],
            input=json.dumps(asked).encode(),
            capture_output=True,
            timeout=_WAIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        said = {"error": TOO_MUCH}
    else:
        said = _said(done)
    if said.get("error") == TOO_MUCH:
        said["error"] = (
            f"it takes more than {SECONDS} s of processor time or {MEMORY >> 30} GB: does a macro "
            "call itself, or is a text doubled without end?"
        )
    if "error" in said:
        raise InputError(f"xacro cannot expand this file: {said['error']}", file=file)
    return str(said["urdf"]).encode()


def _said(done: subprocess.CompletedProcess[bytes]) -> dict[str, Any]:
    """Return what the child says; why it ended, where it says nothing."""
    try:
        said: dict[str, Any] = json.loads(done.stdout)
        return said
    except ValueError:
        *_, last = done.stderr.decode(errors="replace").strip().splitlines() or [""]
    if done.returncode in _LIMITS or last.startswith(MemoryError.__name__):
        return {"error": TOO_MUCH}
    if done.returncode < 0:
        last = signal.strsignal(-done.returncode) or f"signal {-done.returncode}"
    return {"error": f"the process that expands it has failed: {last or 'it says nothing'}"}


def _text(value: str | bool | float) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)

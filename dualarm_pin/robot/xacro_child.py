"""The process in which a xacro file is expanded: it ends before it takes all time or memory.

A macro may call itself, or ten others that call ten others, and a text may be doubled forty times:
no count of ours meets every way of doing that, and the limits of a process do.
"""

from __future__ import annotations

import json
import resource
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

from dualarm_pin.errors import InputError
from dualarm_pin.robot.packages import find_package
from dualarm_pin.robot.xacro_expressions import harmless

LONGEST = 50_000_000  # characters of a URDF
TOO_MUCH = "too much"


def main() -> None:
    """Expand the file that standard input asks for; print JSON with `urdf` or `error`."""
    asked = json.load(sys.stdin)
    memory, seconds = asked["memory"], asked["seconds"]
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        folders = [Path(each) for each in asked["package_dirs"]]
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            urdf = _expanded(Path(asked["file"]), asked["arguments"], folders)
        said = {"urdf": urdf} if len(urdf) <= LONGEST else {"error": TOO_MUCH}
    except (MemoryError, RecursionError):
        said = {"error": TOO_MUCH}
    except Exception as error:  # xacro raises its own kinds, and whatever an expression raises
        said = {"error": _reason(error)}
    json.dump(said, sys.stdout)


def _expanded(file: Path, arguments: Mapping[str, str], package_dirs: Sequence[Path]) -> str:
    import xacrodoc

    module = xacrodoc.xacrodoc
    # xacrodoc gives a text alone: without this, bare names of files and $(dirname) mean nothing.
    module.xacro.init_stacks(str(file))
    module.xacro.substitution_args_context["filename"] = str(file)
    with (
        _packages_of(module.substitution_args, file, package_dirs),
        harmless(module.xacro, module.substitution_args),
    ):
        doc = xacrodoc.XacroDoc.from_file(str(file), subargs=arguments, resolve_packages=False)
        return str(doc.to_urdf_string(use_protocols=True))


@contextmanager
def _packages_of(substitution: Any, file: Path, package_dirs: Sequence[Path]) -> Iterator[None]:
    """Let `$(find ...)` find packages by our own rule, not by the environment."""
    before = substitution._eval_find
    substitution._eval_find = lambda name: str(find_package(name, file.parent, package_dirs))
    try:
        yield
    finally:
        substitution._eval_find = before


def _reason(error: BaseException) -> str:
    """Return the first line of what xacro says, or our own message inside of it."""
    inner = error
    while isinstance(getattr(inner, "exc", None), Exception):
        inner = inner.exc  # type: ignore[attr-defined]
    if isinstance(inner, RecursionError | MemoryError):
        return TOO_MUCH
    text = str(inner if isinstance(inner, InputError) else error).strip()
    return text.splitlines()[0] if text else type(error).__name__

"""Expand xacro through xacrodoc, an extra; ROS itself is never needed, and no code is run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dualarm_pin.errors import InputError, MissingExtraError
from dualarm_pin.robot.packages import find_package
from dualarm_pin.robot.xacro_expressions import harmless


def expand_xacro(
    file: Path, arguments: Mapping[str, str | bool | float], package_dirs: Sequence[Path]
) -> bytes:
    """Return the URDF text that a xacro file expands to.

    Args:
        file: The xacro file.
        arguments: Values of its `<xacro:arg>`.
        package_dirs: Folders that hold the packages it finds with `$(find ...)`.

    Raises:
        MissingExtraError: xacrodoc is not installed.
        InputError: The file cannot be expanded, or an expression in it is more than arithmetic.
    """
    try:
        import xacrodoc
    except ImportError as error:
        raise MissingExtraError(
            f"{file}: xacro files need xacrodoc: pip install 'dualarm-pin[xacro]', or expand the "
            "file with `xacro in.xacro -o out.urdf`"
        ) from error
    given = {key: _text(value) for key, value in arguments.items()}
    try:
        module = xacrodoc.xacrodoc
        with (
            _packages_of(xacrodoc, file, package_dirs),
            harmless(module.xacro, module.substitution_args),
        ):
            doc = xacrodoc.XacroDoc.from_file(str(file), subargs=given, resolve_packages=False)
            return str(doc.to_urdf_string(use_protocols=True)).encode()
    except Exception as error:  # xacro raises its own kinds, and whatever an expression raises
        raise InputError(f"xacro cannot expand this file: {_reason(error)}", file=file) from error


@contextmanager
def _packages_of(xacrodoc: Any, file: Path, package_dirs: Sequence[Path]) -> Iterator[None]:
    """Let `$(find ...)` find packages by our own rule, not by the environment."""
    substitution = xacrodoc.xacrodoc.substitution_args
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
    text = str(inner if isinstance(inner, InputError) else error).strip()
    return text.splitlines()[0] if text else type(error).__name__


def _text(value: str | bool | float) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)

"""Read a task file and the cell it names, with the changes of `--set` applied."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from ruamel.yaml.error import YAMLError

from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.source import DEEPEST, Change, Key, Source, read_yaml, yaml_of


def read_task(
    path: str | Path,
    overrides: Sequence[str] = (),
    read: Callable[[Path], Source] = read_yaml,
) -> tuple[Source, Source, tuple[Key, ...]]:
    """Read a task file and the cell it names, with `key=value` overrides applied.

    Keys are dotted: `smoothness=30`, `path.corner.side=0.2`; those that begin with `cell.` reach
    into the cell: `cell.arms.arm2.base.xyz=[2.4, 0, 0]`.

    Args:
        path: The task file.
        overrides: The changes.
        read: Reads a file; a caller that reads the same ones many times keeps them.

    Returns:
        The task; the file that holds the cell; and where in that file the cell stands: a cell may
        be a file of its own or part of the task file.

    Raises:
        InputError: A file or an override cannot be read.
    """
    changes = [_change(override) for override in overrides]
    task = read(Path(path))
    inside = isinstance(task.data.get("cell"), dict)
    own = [c for c in changes if inside or c.keys[0] != "cell" or len(c.keys) == 1]
    task = task.changed(own)
    named = task.data.get("cell")
    if isinstance(named, dict):
        return task, task, ("cell",)
    if not isinstance(named, str):
        given = "this key is missing" if named is None else f"given {named!r}"
        raise task.error(f"the path of a cell file is expected; {given}", ["cell"])
    try:
        cell = read(task.path.parent / named)
    except MissingFileError as error:
        raise task.error(f"the cell {error}", ["cell"]) from error
    return task, cell.changed([replace(c, keys=c.keys[1:]) for c in changes if c not in own]), ()


@lru_cache(maxsize=4096)  # the variants of a suite share most of theirs
def _change(override: str) -> Change:
    key, separator, text = override.partition("=")
    field = f"--set {override}"
    if not separator or not key.strip():
        raise InputError("give key=value, such as smoothness=30", field=field)
    keys = key.strip().split(".")
    if len(keys) > DEEPEST:
        raise InputError(f"more than {DEEPEST} keys in each other", field=field)
    try:
        value = yaml_of(text)
    except (YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"the value is not YAML: {text!r}", field=field) from error
    return Change([int(k) if k.isdigit() else k for k in keys], value, override)

"""The content of a complete task file: it names the same files from any folder."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from pathlib import Path as FilePath
from typing import Any

from dualarm_pin.files.call import OwnFunction
from dualarm_pin.files.source import Key, Source
from dualarm_pin.path.paths import GENERATORS


def task_record(
    source: Source, cell_source: Source, keys: Sequence[Key], functions: Iterable[OwnFunction] = ()
) -> dict[str, Any]:
    """Return a task with its cell inside, every file by its whole path.

    Args:
        source: The task file.
        cell_source: The file that holds its cell.
        keys: Where in that file the cell stands.
        functions: What it calls of the user's own.
    """
    record: dict[str, Any] = copy.deepcopy(source.values)
    path = record["path"]
    for name in GENERATORS.keys() & path.keys():
        path[name] = _found_anywhere(path[name], source.path.parent)
    folders = {str(own.folder) for own in functions if own.folder is not None}
    if folders:
        record["module_dirs"] = sorted(folders)
    return record | {"cell": _cell_record(cell_source, keys)}


def _cell_record(source: Source, keys: Sequence[Key]) -> dict[str, Any]:
    """Return a cell whose files are found from any folder."""
    record: dict[str, Any] = copy.deepcopy(source.values)
    for key in keys:
        record = record[str(key)]
    folder = source.path.parent
    for part in (record, *record["arms"].values()):
        for key in ("urdf", "srdf"):
            if isinstance(part, dict) and part.get(key) is not None:
                part[key] = _found_anywhere(part[key], folder)
    for thing in (record.get("objects") or {}).values():
        if thing.get("mesh") is not None:
            thing["mesh"] = _found_anywhere(thing["mesh"], folder)
    if record.get("package_dirs"):
        record["package_dirs"] = [_found_anywhere(d, folder) for d in record["package_dirs"]]
    record.setdefault("name", source.path.stem)
    return record


def _found_anywhere(file: Any, folder: FilePath) -> Any:
    """Return a file name that does not depend on the folder it was written in."""
    if isinstance(file, dict):  # a path file with options
        return {k: _found_anywhere(v, folder) if k == "file" else v for k, v in file.items()}
    if not isinstance(file, str) or file.startswith("package://"):
        return file
    return str((folder / file).resolve())

"""The content of a complete task file: it names the same files from any folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath
from typing import Any

from dualarm_pin.files.call import calls_of, module_file
from dualarm_pin.files.source import Key, Source, plain
from dualarm_pin.path.paths import GENERATORS


def task_record(source: Source, cell_source: Source, keys: Sequence[Key]) -> dict[str, Any]:
    """Return a task with its cell inside, every file by its whole path.

    Args:
        source: The task file.
        cell_source: The file that holds its cell.
        keys: Where in that file the cell stands.
    """
    record = _absolute(plain(source.data), source.path.parent)
    folders = {str(folder) for _, call in calls_of(source) for folder in _module_dirs(source, call)}
    if folders:
        record["module_dirs"] = sorted(folders)
    return record | {"cell": _cell_record(cell_source, keys)}


def _module_dirs(source: Source, call: str) -> Sequence[FilePath]:
    """Return the folder in which the module of a call is found, unless Python finds it anyway."""
    module = call.partition(":")[0]
    file = module_file(source, module)
    depth = module.count(".") + (file is not None and file.name == "__init__.py")
    return [] if file is None else [file.parents[depth]]


def _absolute(record: Mapping[str, Any], folder: FilePath) -> dict[str, Any]:
    """Return a task whose path file is found from any folder."""
    path = {
        key: _found_anywhere(value, folder) if key in GENERATORS else value
        for key, value in record["path"].items()
    }
    return {**record, "path": path}


def _cell_record(source: Source, keys: Sequence[Key]) -> dict[str, Any]:
    """Return a cell whose files are found from any folder."""
    data = source.data
    for key in keys:
        data = data[key]
    record: dict[str, Any] = plain(data)
    folder = source.path.parent
    for part in (record, *record["arms"].values()):
        for key in ("urdf", "srdf"):
            if isinstance(part, dict) and part.get(key) is not None:
                part[key] = _found_anywhere(part[key], folder)
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

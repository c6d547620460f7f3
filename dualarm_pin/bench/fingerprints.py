"""Fingerprints of what a task is made of, so that a row can be cited and a batch continued."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import lru_cache, reduce
from operator import getitem
from pathlib import Path
from typing import Any

from dualarm_pin.bench.run import InputHashes, digest
from dualarm_pin.cell import Cell
from dualarm_pin.errors import DualArmError, MissingFileError
from dualarm_pin.files.call import calls_of, module_file, refuse_calls
from dualarm_pin.files.cell_spec import CellSpec
from dualarm_pin.files.read_task import read_task
from dualarm_pin.files.source import Key, Source, check, plain, read_yaml
from dualarm_pin.robot.packages import find_file
from dualarm_pin.robot.xml import parse_xml, read_bytes
from dualarm_pin.task.spec import TaskSpec

_NAMES_FILES = ("urdf", "srdf", "xacro", "package_dirs", "tip", "group")
_PATH_FILES = ("csv", "gcode", "apt")


class Fingerprints:
    """Reads inputs; robots that many variants share are read once."""

    def __init__(self) -> None:
        self._robots: dict[str, dict[Path, str]] = {}
        self._read = lru_cache(maxsize=256)(read_yaml)  # each variant changes a copy

    def read(self, file: Path, changes: Sequence[str], *, allow_code: bool = False) -> InputHashes:
        """Check a variant of a task and return its fingerprints; none of its code is imported.

        Raises:
            InputError: The task, the cell or a change is wrong.
        """
        task, cell, keys = read_task(file, changes, self._read)
        refuse_calls(task, allow_code=allow_code)
        check(task, TaskSpec)
        check(cell, CellSpec, keys)
        robots = dict(self._robots_of(cell, keys))
        for kind in _PATH_FILES:
            named = task.data["path"].get(kind)
            if isinstance(named, str):
                path = (file.parent / named).resolve()
                robots[path] = file_digest(path)
        for _, call in calls_of(task):
            module = module_file(task, call.partition(":")[0])
            if module is not None:
                robots[module] = file_digest(module)
        # The content of the cell counts, not where it stands.
        content = {key: plain(value) for key, value in task.data.items() if key != "cell"}
        files = {str(path): sha for path, sha in robots.items()}
        files |= {str(p.resolve()): file_digest(p.resolve()) for p in (task.path, cell.path)}
        return InputHashes(
            task=digest(content),
            cell=digest(_at(cell, keys)),
            robots={"/".join(path.parts[-3:]): sha for path, sha in sorted(robots.items())},
            files=files,
        )

    def _robots_of(self, cell: Source, keys: Sequence[Key]) -> dict[Path, str]:
        data = _at(cell, keys)
        naming = {k: data.get(k) for k in _NAMES_FILES}
        naming["arms"] = {
            arm: {k: (entry or {}).get(k) for k in _NAMES_FILES}
            for arm, entry in data["arms"].items()
        }
        things = data.get("objects") or {}
        naming["meshes"] = {name: thing.get("mesh") for name, thing in things.items()}
        key = digest([str(cell.path), naming])
        if key not in self._robots:
            self._robots[key] = _read_robots(cell, keys)
        return self._robots[key]


def _at(cell: Source, keys: Sequence[Key]) -> Any:
    """Return the content of a cell, which stands at `keys` of its file."""
    return plain(reduce(getitem, keys, cell.data))


def _read_robots(cell: Source, keys: Sequence[Key]) -> dict[Path, str]:
    """Return the sha256 of URDFs, SRDFs and collision meshes, those of objects among them."""
    loaded = Cell.from_source(cell, keys)
    found = {s.path: s.sha256 for s in loaded.sources if s.path != cell.path.resolve()}
    folder = cell.path.resolve().parent
    extra = [folder / entry for entry in _at(cell, keys).get("package_dirs") or ()]
    for urdf in [path for path in found if path.suffix == ".urdf"]:
        for mesh in collision_meshes(urdf):
            try:
                path = find_file(mesh, urdf.parent, extra).resolve()
            except DualArmError:  # missing meshes leave the clearance unknown, no more
                continue
            found[path] = file_digest(path)
    for thing in loaded.objects:
        if thing.shape.file:
            found[Path(thing.shape.file)] = file_digest(Path(thing.shape.file))
    return found


def collision_meshes(urdf: Path) -> list[str]:
    """Return the names of the mesh files that a URDF checks for collisions."""
    tree = parse_xml(read_bytes(urdf), urdf)
    names = [mesh.get("filename") for mesh in tree.iterfind(".//collision/geometry/mesh")]
    return sorted({name for name in names if name})


def file_digest(path: Path) -> str:
    """Return the sha256 of a file; read again only when its time or size changed.

    Raises:
        MissingFileError: It cannot be read.
    """
    try:
        state = path.stat()
        return _file_digest(path, state.st_mtime_ns, state.st_size)
    except (OSError, ValueError) as error:
        raise MissingFileError(f"cannot be read: {error}", file=path) from error


@lru_cache(maxsize=4096)
def _file_digest(path: Path, changed: int, size: int) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()

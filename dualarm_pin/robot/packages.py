"""Find the files that URDFs and cell files name, by one rule that no environment variable changes.

`package://NAME/rest` is looked up in `package_dirs`, then beside every parent folder of the file
that names it, then in this package and in example-robot-data. ROS_PACKAGE_PATH and
AMENT_PREFIX_PATH are never read: the same files must give the same cell on every machine.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Sequence
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from urllib.parse import unquote

from dualarm_pin.errors import MissingExtraError, MissingFileError
from dualarm_pin.files.read import is_file, is_folder
from dualarm_pin.files.resources import urdf_folder

ROBOTS = "example-robot-data"


def find_file(name: str, folder: Path, package_dirs: Sequence[Path] = ()) -> Path:
    """Return the file that `name` stands for.

    Args:
        name: A path, `package://...` or `file://...`.
        folder: Folder of the file that names it.
        package_dirs: Further folders to search.

    Raises:
        MissingFileError: It is nowhere; the message lists where it was looked for.
        MissingExtraError: It belongs to example-robot-data, which is not installed.
    """
    tried: list[str] = []
    for candidate in _candidates(name, folder, package_dirs):
        if is_file(candidate):
            return _plain(candidate)
        if len(tried) < 4:
            tried.append(str(candidate))
    package = _package(name)[0]
    if package == ROBOTS and robot_data_share() is None:
        raise MissingExtraError(
            f"{name} is part of {ROBOTS}, which is not installed: "
            "pip install 'dualarm-pin[robots]' (about 400 MB)"
        )
    where = ", ".join(tried) or "nowhere"
    hint = "; add the folder that holds the package to package_dirs" if package else ""
    raise MissingFileError(f"no such file: {name} (looked for {where}){hint}")


def _plain(path: Path) -> Path:
    """Return `path` without `..`, unless a symbolic link gives them another meaning."""
    plain = Path(os.path.normpath(path))
    return plain if plain.exists() and plain.samefile(path) else path


@lru_cache(maxsize=1)
def robot_data_share() -> Path | None:
    """Return the folder that holds `example-robot-data`, or None if it is not installed."""
    try:
        files = distribution(ROBOTS).files or []
    except PackageNotFoundError:
        return None
    for file in files:
        parts = file.parts
        for k in range(len(parts) - 2):
            if parts[k : k + 2] == ("share", ROBOTS):
                return Path(str(file.locate())).resolve().parents[len(parts) - k - 2]
    return None


def find_package(package: str, folder: Path, package_dirs: Sequence[Path] = ()) -> Path:
    """Return the folder of a package, found as in `find_file`.

    Raises:
        MissingFileError: It is nowhere.
    """
    for candidate in _package_candidates(package, "", folder, package_dirs):
        if is_folder(candidate):
            return _plain(candidate)
    raise MissingFileError(f"no package {package!r}; add the folder that holds it to package_dirs")


def _leaves(rest: str) -> bool:
    """Return whether a relative path leads out of its folder by `..`, if only on the way."""
    parts = [part for part in rest.split("/") if part not in ("", ".")]
    depths = itertools.accumulate(-1 if part == ".." else 1 for part in parts)
    return any(depth < 0 for depth in depths)


def _package(name: str) -> tuple[str, str]:
    """Split `package://NAME/rest`; both are empty for another name. Extra slashes are let pass.

    Raises:
        MissingFileError: The rest leads out of the package.
    """
    for scheme in ("package://", "model://"):
        if name.startswith(scheme):
            package, _, rest = name.removeprefix(scheme).lstrip("/").partition("/")
            rest = rest.lstrip("/")
            if package in (".", "..") or _leaves(rest):
                message = f"{name} leaves the folder of its package: `..` may not lead out of it"
                raise MissingFileError(message)
            return package, rest
    return "", ""


def _candidates(name: str, folder: Path, package_dirs: Sequence[Path]) -> Iterator[Path]:
    package, rest = _package(name)
    if package:
        yield from _package_candidates(package, rest, folder, package_dirs)
    elif name.startswith("file://"):
        path = name.removeprefix("file://").removeprefix("localhost")
        yield Path(path)
        yield Path(unquote(path))
    elif Path(name).is_absolute():
        yield Path(name)
    else:
        yield folder / name
        for extra in package_dirs:
            yield extra / name


def _package_candidates(
    package: str, rest: str, folder: Path, package_dirs: Sequence[Path]
) -> Iterator[Path]:
    for extra in package_dirs:
        yield extra / package / rest
        if extra.resolve().name == package:
            yield extra / rest
    if package == "dualarm_pin" and rest:
        yield urdf_folder().parent / rest
    share = robot_data_share()
    if package == ROBOTS and share is not None:
        yield share / package / rest
    for parent in (folder.resolve(), *folder.resolve().parents):
        if parent.name == package:
            yield parent / rest
        yield parent / package / rest

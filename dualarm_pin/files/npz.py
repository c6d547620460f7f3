"""Arrays in `.npz` files, without pickle; what is read is not trusted."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.files.read import read_file

_LARGEST = 200_000_000  # bytes of the arrays, unpacked: a zip of 200 kB can stand for so many


def npz_bytes(arrays: Mapping[str, Array], joints: tuple[str, ...]) -> bytes:
    """Return the content of a file of arrays and the names of the joints."""
    data = io.BytesIO()
    named: dict[str, Any] = {**arrays, "joints": np.array(joints, dtype=np.str_)}
    np.savez(data, **named)
    return data.getvalue()


def read_npz(file: Path, axes: Mapping[str, int], *, what: str) -> dict[str, Array]:
    """Read arrays of numbers.

    Args:
        file: The file.
        axes: Name of each array that must be there to its number of axes.
        what: What the file holds, for messages.

    Raises:
        MissingFileError: There is no such file.
        InputError: It is damaged or too large, or an array is missing or of another kind.
    """
    found = _load(file, axes, what)
    for name, array in found.items():
        if array.ndim != axes[name] or array.dtype.kind not in "fiu":
            raise InputError(
                f"{axes[name]} axes of numbers are expected; given {array.dtype}, "
                f"shape {array.shape}",
                file=file,
                field=name,
            )
    return {name: np.asarray(array, dtype=np.float64) for name, array in found.items()}


def read_joint_names(file: Path, *, what: str) -> tuple[str, ...]:
    """Read the names of the joints beside the arrays.

    Raises:
        MissingFileError: There is no such file.
        InputError: It is damaged or too large, or holds no names.
    """
    names = _load(file, ["joints"], what)["joints"]
    if names.ndim != 1 or names.dtype.kind != "U":
        message = f"a list of names is expected; given {names.dtype}, shape {names.shape}"
        raise InputError(message, file=file, field="joints")
    return tuple(names.tolist())


def _load(file: Path, names: Iterable[str], what: str) -> dict[str, NDArray[Any]]:
    try:
        raw = io.BytesIO(read_file(file, _LARGEST, "its arrays stand beside result.json"))
        with zipfile.ZipFile(raw) as archive:
            unpacked = sum(part.file_size for part in archive.infolist())
        if unpacked > _LARGEST:
            message = f"its arrays take {unpacked} bytes, {_LARGEST} are allowed"
            raise InputError(f"not {what} of this program: {message}", file=file)
        with np.load(raw, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in names}
    except InputError:
        raise
    except Exception as error:  # a damaged archive fails anywhere in zipfile, zlib and numpy
        raise InputError(f"not {what} of this program: {error}", file=file) from error

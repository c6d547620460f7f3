"""Where the robots, cells and tasks that ship with the package are."""

from __future__ import annotations

from pathlib import Path

from dualarm_pin.errors import MissingFileError

_PACKAGE = Path(__file__).resolve().parents[1]


def urdf_folder() -> Path:
    """Return the folder `urdf/`, the same from a wheel and from an editable install.

    Raises:
        MissingFileError: The installation lost it.
    """
    for folder in (_PACKAGE / "urdf", _PACKAGE.parent / "urdf"):
        if (folder / "ns16").is_dir():
            return folder
    raise MissingFileError("the folder of robots is missing: install the package again")

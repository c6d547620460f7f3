"""How the controller of an arm counts its axes: what a cell file says, checked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell.joint_settings import Blame
from dualarm_pin.cell.parts import Controller, Joint, read_only
from dualarm_pin.errors import nearest
from dualarm_pin.files.cell_spec import ControllerSpec
from dualarm_pin.tolerance import TOLERANCE


def controller_of(
    spec: ControllerSpec, joints: Sequence[Joint], blame: Blame, place: Sequence[str]
) -> Controller:
    """Return the controller of an arm as its cell file describes it.

    Args:
        spec: What the file says.
        joints: The joints of the arm, base to tip.
        blame: Makes an error of the cell file.
        place: Where in it the specification stands.

    Raises:
        InputError: A joint is not one of the arm, or takes no degrees, or a coupling has no way
            back.
    """
    names = [joint.name.partition("/")[2] for joint in joints]
    for key, name in _named(spec):
        if name not in names:
            message = f"the arm moves no joint {name!r}: {nearest(name, names)}"
            raise blame(message, (*place, key, name))
    for name in spec.offsets_deg:
        if joints[names.index(name)].kind == "prismatic":
            message = f"joint {name!r} is prismatic: it takes no offset"
            raise blame(message, (*place, "offsets_deg", name))
    return Controller(
        signs=read_only([spec.signs.get(name, 1) for name in names]),
        offsets=read_only([math.radians(spec.offsets_deg.get(name, 0.0)) for name in names]),
        coupling=_coupling(spec, names, blame, place),
        prefix=spec.prefix,
    )


def unusual(controller: Controller, joints: Sequence[str]) -> dict[str, Any]:
    """Return what is not as usual, as a cell file says it."""
    names = [joint.partition("/")[2] for joint in joints]
    said: dict[str, Any] = {}
    signs = {n: int(s) for n, s in zip(names, controller.signs, strict=True) if s < 0}
    offsets = {n: math.degrees(o) for n, o in zip(names, controller.offsets, strict=True) if o}
    if signs:
        said["signs"] = signs
    if offsets:
        said["offsets_deg"] = offsets
    if controller.coupling is not None:
        said["coupling"] = {
            name: {names[k]: float(row[k]) for k in np.flatnonzero(row)}
            for name, row in zip(names, controller.coupling, strict=True)
            if row.any()
        }
    if controller.prefix is not None:
        said["prefix"] = controller.prefix
    return said


def _named(spec: ControllerSpec) -> Iterator[tuple[str, str]]:
    yield from (("signs", name) for name in spec.signs)
    yield from (("offsets_deg", name) for name in spec.offsets_deg)
    for name, others in (spec.coupling or {}).items():
        yield from (("coupling", each) for each in (name, *others))


def _coupling(
    spec: ControllerSpec, names: Sequence[str], blame: Blame, place: Sequence[str]
) -> Array | None:
    if spec.coupling is None:
        return None
    matrix = np.zeros((len(names), len(names)))
    for name, others in spec.coupling.items():
        for other, factor in others.items():
            matrix[names.index(name), names.index(other)] = factor
    if len(names) and 1.0 / np.linalg.cond(np.eye(len(names)) + matrix) < TOLERANCE.rank:
        raise blame("the joints do not follow from these axes", (*place, "coupling"))
    return read_only(matrix)

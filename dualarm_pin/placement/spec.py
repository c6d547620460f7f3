"""What the `placement:` section of a task file may hold.

placement:
base2: {x: [1.4, 3.0], y: [-0.8, 0.8], z: [-0.5, 0.5], yaw_deg: [90, 270]}   # in the world
workpiece: {x: [-0.1, 0.1], yaw_deg: [-30, 30]}   # the path in e1, from where it is
tool2: {length: [0, 0.1]}                         # along the tool, from what it is [m]
keep_out: [{x: [1.8, 2.2], y: [-0.3, 0.3]}]       # areas of the floor
weights: {base2.y: 0.1}                           # of (change)^2, for what should stay
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from dualarm_pin.cell import Cell
from dualarm_pin.files.cell_spec import Bounds
from dualarm_pin.files.source import Spec
from dualarm_pin.placement.asked import Area, Asked, asked
from dualarm_pin.placement.parameters import BASE, TOOL, WORKPIECE


class PoseSpec(Spec):
    """From and to of a pose.

    Attributes:
        x: Along x [m], such as `[1.4, 3.0]`.
        y: Along y [m], such as `[-0.8, 0.8]`.
        z: Along z [m], such as `[-0.5, 0.5]`.
        yaw_deg: About the vertical [deg], such as `[90, 270]`.
    """

    x: Bounds | None = None
    y: Bounds | None = None
    z: Bounds | None = None
    yaw_deg: Bounds | None = None


class ToolSpec(Spec):
    """From and to of a tool.

    Attributes:
        length: What it is longer by, along its axis [m], such as `[0, 0.1]`.
    """

    length: Bounds | None = None


class AreaSpec(Spec):
    """A rectangle of the floor.

    Attributes:
        x: From and to in the world [m], such as `[1.8, 2.2]`.
        y: From and to in the world [m], such as `[-0.3, 0.3]`.
    """

    x: Bounds
    y: Bounds


class FreeSpec(Spec):
    """The whole section.

    Attributes:
        base2: Where the base of arm 2 may stand, in the world, such as `{x: [1.4, 3.0]}`.
        workpiece: Where the path may lie in e1, from where it is, such as `{x: [-0.1, 0.1]}`.
        tool2: How much longer the tool of arm 2 may be, such as `{length: [0, 0.1]}`.
        keep_out: Areas of the floor in which the origin of base 2 must not stand.
        weights: Weights of (change)^2 in the objective, for what should stay, such as
            `{base2.y: 0.1}`.
    """

    base2: PoseSpec = PoseSpec()
    workpiece: PoseSpec = PoseSpec()
    tool2: ToolSpec = ToolSpec()
    keep_out: list[AreaSpec] = Field(default_factory=list)
    weights: dict[str, Annotated[float, Field(ge=0)]] = Field(default_factory=dict)


def load_placement(spec: FreeSpec | None, cell: Cell) -> Asked | None:
    """Return what may change, checked against the cell; None where nothing is asked.

    Raises:
        InputError: As `asked`; the field names the key.
    """
    if spec is None:
        return None
    boxes = {}
    for group, part in ((BASE, spec.base2), (WORKPIECE, spec.workpiece), (TOOL, spec.tool2)):
        for key, box in part:
            if box is not None and key.endswith("_deg"):
                boxes[f"{group}.{key[:-4]}"] = (math.radians(box[0]), math.radians(box[1]))
            elif box is not None:
                boxes[f"{group}.{key}"] = box
    areas = tuple(Area(area.x, area.y) for area in spec.keep_out)
    return asked(cell, boxes, keep_out=areas, weights=spec.weights)

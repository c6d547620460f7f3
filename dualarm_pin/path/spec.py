"""What the `path:` section of a task file may hold.

One generator of `path.paths.GENERATORS`, or `call`, and how the tool is held:

    path:
      circle: {radius: 0.1, points: 49}      # or step: 0.005, the largest distance of neighbours
      rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]   # or rpy_deg: [180, 0, 0]
      orientation: constant                  # tangent | normal | normal_tangent
      free: none                             # spin | rotation; or a list, one for each point
      spin_axis: [0, 0, 1]                   # in e2, for free: spin
      frame: {xyz: [0, 0, 0], rpy_deg: [0, 0, 0]}   # moves the whole path within e1

    path: {call: "my_paths:zigzag", width: 0.1, points: 20, free: spin}    # see `files.call`

Lengths in metres; angles in degrees where the key ends in `_deg`. What each key means stands in
the docstring of the generator of the same name.
"""

from __future__ import annotations

from typing import Literal, Self

from pydantic import model_validator

from dualarm_pin.files.cell_spec import PlacementSpec
from dualarm_pin.files.numbers import Vector
from dualarm_pin.files.one_of import OneOf, one_of
from dualarm_pin.files.source import Spec
from dualarm_pin.path.paths import GENERATORS

Free = Literal["none", "spin", "rotation"]


class HoldSpec(Spec):
    """How the tool is held along a path.

    Attributes:
        rotation: Axes of the tool frame e2 in e1 as three rows; the tools face each other by
            default, such as `[[1, 0, 0], [0, -1, 0], [0, 0, -1]]`.
        rpy_deg: The same rotation as roll, pitch and yaw [deg], such as `[180, 0, 0]`.
        orientation: What the tool does along the curve: `constant` keeps the rotation, `tangent`
            turns x along the curve, `normal` turns z into the surface, `normal_tangent` both, such
            as `tangent`.
        free: What is free at every point, or a list with one for each: `none`, `spin` about
            `spin_axis`, or the whole `rotation`, such as `spin`.
        spin_axis: Axis in e2 about which the tool may turn, such as `[0, 0, 1]`.
        frame: Pose in e1 of the frame in which the curve is drawn: it moves the whole path.
    """

    rotation: tuple[Vector, Vector, Vector] | None = None
    rpy_deg: Vector | None = None
    orientation: Literal["constant", "tangent", "normal", "normal_tangent"] | None = None
    free: Free | list[Free] = "none"
    spin_axis: Vector = (0.0, 0.0, 1.0)
    frame: PlacementSpec | None = None

    @model_validator(mode="after")
    def _one_rotation(self) -> Self:
        if self.rotation is not None and self.rpy_deg is not None:
            raise ValueError("give rotation or rpy_deg: both are given")
        return self


@one_of(GENERATORS)
class PathSpec(HoldSpec, OneOf):
    """The `path:` section: one curve and how the tool is held.

    Attributes:
        call: A function of your own that returns a `Path`; its arguments stand beside it, such as
            `my_paths:zigzag`.
    """

    noun = "curve"

"""Build bodies for Pinocchio and Coal; what cannot be loaded is listed, never fatal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import coal
import numpy as np
import pinocchio as pin

from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.cell.poses import pose_of
from dualarm_pin.errors import DualArmError
from dualarm_pin.meshes.load import load_mesh
from dualarm_pin.robot.packages import find_file
from dualarm_pin.robot.robot import Shape


@dataclass(frozen=True)
class Bodies:
    """Geometry of one kind.

    Attributes:
        model: The objects, placed on the joints of the cell's model.
        links: For each object its link, `arm1/<link>`.
        missing: What could not be loaded, and why.
    """

    model: pin.GeometryModel
    links: tuple[str, ...]
    missing: tuple[str, ...]


def build_bodies(
    model: pin.Model,
    robots: Sequence[PlacedRobot],
    kind: Literal["visual", "collision"],
    package_dirs: Sequence[Path],
    hulls: bool = False,
) -> Bodies:
    """Return all bodies of one kind, meshes as they are or as their convex hulls."""
    geometry = pin.GeometryModel()
    links: list[str] = []
    missing: dict[str, None] = {}
    for placed in robots:
        frames = placed.frames
        robot = placed.chains.robot
        for link in robot.links.values():
            missing |= dict.fromkeys(
                f"{placed.link(link.name)}: {note}" for note in link.unknown if f"<{kind}>" in note
            )
            frame_id = model.getFrameId(frames[link.name], pin.FrameType.BODY)
            frame = model.frames[frame_id]
            shapes = link.visuals if kind == "visual" else link.collisions
            for number, shape in enumerate(shapes):
                folder = robot.file.resolve().parent
                try:
                    body, path = _body(shape, folder, package_dirs, hulls)
                except DualArmError as error:
                    missing[f"{placed.link(link.name)}: {error}"] = None
                    continue
                thing = pin.GeometryObject(
                    f"{placed.link(link.name)}_{number}",
                    frame.parentJoint,
                    frame_id,
                    frame.placement * pose_of(shape.xyz, shape.rpy),
                    body,
                )
                if path is not None:
                    thing.meshPath, thing.meshScale = str(path), np.array(shape.size)
                if shape.colour is not None:
                    thing.meshColor, thing.overrideMaterial = np.array(shape.colour), True
                geometry.addGeometryObject(thing)
                links.append(placed.link(link.name))
    return Bodies(geometry, tuple(links), tuple(missing))


def _body(
    shape: Shape, folder: Path, package_dirs: Sequence[Path], hull: bool
) -> tuple[coal.CollisionGeometry, Path | None]:
    size = shape.size
    if shape.kind == "mesh":
        path = find_file(shape.file, folder, package_dirs)
        return load_mesh(path, (size[0], size[1], size[2]), hull), path
    if shape.kind == "box":
        return coal.Box(*size), None
    if shape.kind == "sphere":
        return coal.Sphere(*size), None
    if shape.kind == "cylinder":
        return coal.Cylinder(*size), None
    return coal.Capsule(*size), None

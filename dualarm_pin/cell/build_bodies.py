"""Build bodies for Pinocchio and Coal; what cannot be loaded is listed, never fatal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import coal
import numpy as np
import pinocchio as pin

from dualarm_pin.cell.objects import WORLD, PlacedObject
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.cell.poses import pose_of
from dualarm_pin.errors import DualArmError, InputError
from dualarm_pin.meshes.load import load_mesh
from dualarm_pin.robot.packages import find_file
from dualarm_pin.robot.robot import Shape

_PRIMITIVES = {
    "box": coal.Box,
    "sphere": coal.Sphere,
    "cylinder": coal.Cylinder,
    "capsule": coal.Capsule,
}


@dataclass(frozen=True)
class Bodies:
    """Geometry of one kind.

    Attributes:
        model: The objects, placed on the joints of the cell's model.
        links: For each body the name of its link, `arm1/<link>`, or of an object.
        owners: For each body with what it moves: `arm1`, `arm2`, `common` or `world`.
        missing: What could not be loaded, and why.
    """

    model: pin.GeometryModel
    links: tuple[str, ...]
    owners: tuple[str, ...]
    missing: tuple[str, ...]


def build_bodies(
    model: pin.Model,
    robots: Sequence[PlacedRobot],
    kind: Literal["visual", "collision"],
    package_dirs: Sequence[Path],
    hulls: bool = False,
    objects: Sequence[PlacedObject] = (),
) -> Bodies:
    """Return all bodies of one kind, meshes as they are or as their convex hulls.

    Raises:
        InputError: The mesh of an object is damaged.
    """
    geometry = pin.GeometryModel()
    links: list[str] = []
    owners: list[str] = []
    missing: dict[str, None] = {}
    for placed in robots:
        robot, folder = placed.chains.robot, placed.chains.robot.file.resolve().parent
        for link in robot.links.values():
            name = placed.link(link.name)
            missing |= {f"{name}: {note}": None for note in link.unknown if f"<{kind}>" in note}
            frame_id = model.getFrameId(placed.frames[link.name], pin.FrameType.BODY)
            shapes = link.visuals if kind == "visual" else link.collisions
            for number, shape in enumerate(shapes):
                try:
                    body, path = _body(shape, folder, package_dirs, hulls)
                except DualArmError as error:
                    missing[f"{name}: {error}"] = None
                    continue
                pose = pose_of(shape.xyz, shape.rpy)
                geometry.addGeometryObject(
                    _placed(f"{name}_{number}", model, frame_id, pose, shape, body, path)
                )
                links.append(name)
                owners.append(placed.chains.owner[link.name])
    for thing in objects:
        frame_id = 0 if thing.owner == WORLD else model.getFrameId(thing.frame, pin.FrameType.BODY)
        try:
            body, path = _body(thing.shape, Path(), (), hulls)
        except DualArmError as error:
            raise InputError(str(error), field=f"objects.{thing.name}.mesh") from error
        geometry.addGeometryObject(
            _placed(thing.name, model, frame_id, thing.pose, thing.shape, body, path)
        )
        links.append(thing.name)
        owners.append(thing.owner)
    return Bodies(geometry, tuple(links), tuple(owners), tuple(missing))


def _placed(
    name: str,
    model: pin.Model,
    frame_id: int,
    pose: pin.SE3,
    shape: Shape,
    body: coal.CollisionGeometry,
    path: Path | None,
) -> pin.GeometryObject:
    frame = model.frames[frame_id]
    thing = pin.GeometryObject(name, frame.parentJoint, frame_id, frame.placement * pose, body)
    if path is not None:
        thing.meshPath, thing.meshScale = str(path), np.array(shape.size)
    if shape.colour is not None:
        thing.meshColor, thing.overrideMaterial = np.array(shape.colour), True
    return thing


def _body(
    shape: Shape, folder: Path, package_dirs: Sequence[Path], hull: bool
) -> tuple[coal.CollisionGeometry, Path | None]:
    if shape.kind != "mesh":
        return _PRIMITIVES[shape.kind](*shape.size), None
    path = find_file(shape.file, folder, package_dirs)
    x, y, z = shape.size
    return load_mesh(path, (x, y, z), hull), path

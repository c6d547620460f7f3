"""Things that stand in a cell or are carried: shapes of the user's beside those of the URDFs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin

from dualarm_pin.cell.merged_urdf import TOOLS
from dualarm_pin.cell.parts import ARMS
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.cell.read_robots import Loader
from dualarm_pin.errors import nearest
from dualarm_pin.files.cell_spec import ObjectSpec
from dualarm_pin.robot.robot import Shape

WORLD = "world"
_UNIVERSE = "universe"  # Pinocchio's name of the frame that never moves
_TAKEN = (WORLD, *ARMS, "common")


@dataclass(frozen=True)
class PlacedObject:
    """A body that no URDF names.

    Attributes:
        name: Its name, without a slash: never that of a link.
        shape: What it is; its pose in the frame is `pose`.
        on: What carries it, as the user said.
        owner: `arm1`, `arm2`, `common` or `world`: with what it moves.
        frame: Frame of the cell's model that carries it.
        pose: Pose in that frame.
        allowed: Bodies that it may touch.
    """

    name: str
    shape: Shape
    on: str
    owner: str
    frame: str
    pose: pin.SE3
    allowed: frozenset[str]

    @property
    def text(self) -> str:
        """What it is, for people."""
        if self.shape.kind == "mesh":
            return f"mesh {Path(self.shape.file).name}"
        return f"{self.shape.kind} {' x '.join(f'{length:g}' for length in self.shape.size)} m"


def placed_objects(loader: Loader, robots: Sequence[PlacedRobot]) -> tuple[PlacedObject, ...]:
    """Return the objects that a cell file asks for, each on the frame that carries it.

    Raises:
        MissingFileError: A mesh does not exist.
        InputError: A name is taken, or nothing of the name of its carrier or neighbour exists.
    """
    specs, blame = loader.spec.objects, loader.blame
    carriers = dict(_carriers(robots))
    bodies = {*specs, *colliding_links(robots)}
    found = []
    for name, spec in specs.items():
        if not name or "/" in name or name in _TAKEN or any(c.isspace() for c in name):
            message = (
                f"{name!r} cannot name an object: no slash, no space, and none of "
                f"{', '.join(_TAKEN)}"
            )
            raise blame(message, ("objects", name))
        if spec.on not in carriers:
            message = f"nothing named {spec.on!r} can carry it: {nearest(spec.on, carriers)}"
            raise blame(message, ("objects", name, "on"))
        for body in spec.allow:
            if body not in bodies - {name}:
                message = f"no other body {body!r} in this cell: {nearest(body, bodies - {name})}"
                raise blame(message, ("objects", name, "allow"))
        owner, frame = carriers[spec.on]
        file = loader.find(spec.mesh, ("objects", name, "mesh")) if spec.mesh else None
        shape = _shape(spec, file)
        allowed = frozenset(spec.allow)
        found.append(PlacedObject(name, shape, spec.on, owner, frame, spec.at.pose, allowed))
    return tuple(found)


def _carriers(robots: Sequence[PlacedRobot]) -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield what can carry an object, and its owner and frame."""
    yield WORLD, (WORLD, _UNIVERSE)
    for arm, tool in zip(ARMS, TOOLS, strict=True):
        yield arm, (arm, tool)
    for placed in robots:
        for link in placed.chains.robot.links:
            yield placed.link(link), (placed.chains.owner[link], placed.frames[link])


def colliding_links(robots: Sequence[PlacedRobot]) -> Iterator[str]:
    """Yield the links that have a collision body."""
    for placed in robots:
        for link in placed.chains.robot.links.values():
            if link.collisions:
                yield placed.link(link.name)


def _shape(spec: ObjectSpec, file: Path | None) -> Shape:
    zero, size = (0.0, 0.0, 0.0), (spec.scale,) * 3
    round_ = spec.cylinder or spec.capsule
    if round_ is not None:
        return Shape(spec.kind, (round_.radius, round_.length), "", zero, zero, _COLOUR, 0)
    if spec.sphere is not None:
        return Shape(spec.kind, (spec.sphere,), "", zero, zero, _COLOUR, 0)
    return Shape(spec.kind, spec.box or size, str(file or ""), zero, zero, _COLOUR, 0)


_COLOUR = (0.55, 0.47, 0.36, 1.0)  # unlike any robot of the tests, so that it shows

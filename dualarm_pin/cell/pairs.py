"""Which pairs of bodies are checked for collision, and why the others are not."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from dualarm_pin.cell.build_bodies import Bodies
from dualarm_pin.cell.objects import PlacedObject
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.errors import InputError

_ALWAYS = 0.9  # share of random configurations above which a pair says nothing
_SAMPLES = 100


def add_pairs(
    model: pin.Model,
    bodies: Bodies,
    robots: Sequence[PlacedRobot],
    objects: Sequence[PlacedObject],
    disabled: Mapping[int, frozenset[frozenset[str]]],
    configurations: np.ndarray,
) -> tuple[str, ...]:
    """Add the collision pairs to the geometry of a cell.

    Left out are pairs that no joint moves, links that one joint connects, pairs the SRDF disables
    or an object allows, and, for a robot without SRDF, pairs of its own links that collide nearly
    always.

    Args:
        model: Model of the cell.
        bodies: Its collision bodies; their pairs are set here.
        robots: The placed URDFs.
        objects: What stands in the cell or is carried.
        disabled: Number of a robot to the pairs of plain link names its SRDF disables.
        configurations: Random q of the model (m, nv), to find pairs that always collide.

    Returns:
        Notes on what was left out because it nearly always collides.

    Raises:
        InputError: An object collides nearly always: it stands in the way.
    """
    geometry = bodies.model
    body = _rigid_bodies(robots)
    off = {
        frozenset(robots[number].link(link) for link in pair)
        for number, pairs in disabled.items()
        for pair in pairs
    }
    off |= {frozenset((thing.name, body)) for thing in objects for body in thing.allowed}
    body |= {
        thing.name: (-1 - number, thing.name, frozenset()) for number, thing in enumerate(objects)
    }
    for (i, first), (j, second) in itertools.combinations(enumerate(bodies.links), 2):
        a, b = geometry.geometryObjects[i], geometry.geometryObjects[j]
        neighbours = frozenset((body[first][1], body[second][1]))
        joined = body[first][0] == body[second][0] and neighbours in body[first][2]
        if a.parentJoint != b.parentJoint and frozenset((first, second)) not in off and not joined:
            geometry.addCollisionPair(pin.CollisionPair(i, j))
    return _drop_constant(model, bodies, body, set(disabled), configurations)


Body = tuple[int, str, frozenset[frozenset[str]]]


def _rigid_bodies(robots: Sequence[PlacedRobot]) -> dict[str, Body]:
    """Return for each link its robot, its rigid body, and the neighbouring bodies of that robot."""
    found: dict[str, Body] = {}
    for number, placed in enumerate(robots):
        robot, head = placed.chains.robot, placed.heads
        touching = frozenset(
            frozenset((head[joint.parent], head[joint.child]))
            for joint in robot.joints.values()
            if head[joint.parent] != head[joint.child]
        )
        for link in robot.links:
            found[placed.link(link)] = (number, head[link], touching)
    return found


def _drop_constant(
    model: pin.Model,
    bodies: Bodies,
    body: Mapping[str, Body],
    described: set[int],
    configurations: np.ndarray,
) -> tuple[str, ...]:
    geometry = bodies.model
    # Plain numbers: the pairs themselves are views that shift when one is removed.
    pairs = [(pair.first, pair.second) for pair in geometry.collisionPairs]
    robots = [tuple(body[bodies.links[k]][0] for k in pair) for pair in pairs]
    judged = [
        k
        for k, (i, j) in enumerate(robots)
        if (i == j and i not in described) or min(i, j) < 0  # an object is of no robot
    ]
    if not judged or not len(configurations):
        return ()
    data, hits = model.createData(), np.zeros(len(pairs))
    scene = geometry.createData()
    for q in configurations:
        pin.computeCollisions(model, data, geometry, scene, q, False)
        hits += [result.isCollision() for result in scene.collisionResults]
    names: dict[str, None] = {}
    for k in judged:
        i, j = pairs[k]
        if hits[k] < _ALWAYS * len(configurations):
            continue
        for thing, other in ((i, j), (j, i)):
            if body[bodies.links[thing]][0] < 0:
                name, of = bodies.links[thing], bodies.links[other]
                raise InputError(
                    f"touches {of} in nearly every posture: move it (`at`), or say `allow: [{of}]`",
                    field=f"objects.{name}",
                )
        geometry.removeCollisionPair(pin.CollisionPair(i, j))
        first, second = sorted((bodies.links[i], bodies.links[j]))
        names[f"{first} and {second} touch in nearly every posture: not checked"] = None
    return tuple(names)

"""Model and bodies of a cell with its bases elsewhere: copies, nothing is read or loaded again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pinocchio as pin

from dualarm_pin.cell.build_bodies import Bodies
from dualarm_pin.cell.merged_urdf import BASE, TOOL, TOOLS
from dualarm_pin.cell.parts import ARMS, Arm
from dualarm_pin.cell.placed_robot import PlacedRobot

Moves = Mapping[str, pin.SE3]  # arm to the motion of its base in the world


def base_moves(before: tuple[Arm, Arm], after: tuple[Arm, Arm]) -> Moves:
    """Return how the bases that moved have moved."""
    return {
        old.name: new.base * old.base.inverse()
        for old, new in zip(before, after, strict=True)
        if old.base != new.base
    }


def moved_model(model: pin.Model, robots: Sequence[PlacedRobot], moves: Moves) -> pin.Model:
    """Return a copy of a model in which everything that stands on the bases has moved."""
    moved, move = pin.Model(model), _moves_of_frames(model, robots, moves)
    for joint in range(1, model.njoints):
        frame = model.getFrameId(model.names[joint], pin.FrameType.JOINT)
        if model.parents[joint] == 0 and frame in move:
            moved.jointPlacements[joint] = move[frame] * model.jointPlacements[joint]
    standing = pin.Inertia.Zero()
    for k, frame in enumerate(model.frames):
        if frame.parentJoint == 0:
            if k in move:
                moved.frames[k].placement = move[k] * frame.placement
            standing += moved.frames[k].placement.act(frame.inertia)
    moved.inertias[0] = standing
    return moved


def moved_bodies(
    bodies: Bodies, model: pin.Model, robots: Sequence[PlacedRobot], moves: Moves
) -> Bodies:
    """Return a copy of bodies, loaded for `model`, of which those on the bases have moved.

    Shapes are shared.
    """
    moved, move = pin.GeometryModel(bodies.model), _moves_of_frames(model, robots, moves)
    for item in moved.geometryObjects:
        if item.parentJoint == 0 and item.parentFrame in move:
            item.placement = move[item.parentFrame] * item.placement
    return replace(bodies, model=moved)


def _moves_of_frames(
    model: pin.Model, robots: Sequence[PlacedRobot], moves: Moves
) -> dict[int, pin.SE3]:
    """Return the motion of every frame that hangs from a base that moved."""
    roots = {f"{TOOL}{tool}": arm for tool, arm in zip(TOOLS, ARMS, strict=True)}
    for number, placed in enumerate(robots, start=1):
        arm, *others = placed.chains.tips
        if not others:
            roots[f"{BASE}{number}"] = arm
    arm_of: dict[int, str] = {}
    for k, frame in enumerate(model.frames):  # parents come first
        whose = arm_of.get(frame.parentFrame) or roots.get(frame.name)
        if whose:
            arm_of[k] = whose
    return {k: moves[arm] for k, arm in arm_of.items() if arm in moves}

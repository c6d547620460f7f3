"""A `CellReport` as a plain table."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dualarm_pin.cell.parts import MOTION_KEYS, Joint
from dualarm_pin.cell.report import ArmReport, CellReport, ObjectReport

_DEG = 180.0 / math.pi
_HUGE = 20.0  # m; no robot of the tests reaches a fifth of it
_SHOWN = 12  # lines of a list that can be very long


def text_of(report: CellReport) -> str:
    """Return a plain table for people; angles in degrees."""
    blocks = [f"Cell {report.name}: {len(report.joints)} joints"]
    blocks += [_arm(arm) for arm in report.arms]
    blocks.append(_joints(report.joints))
    blocks.append(_motion_limits(report.joints))
    if report.locked:
        locked = [f"{name} = {value:g}" for name, value in report.locked.items()]
        blocks.append(_list(f"Locked joints ({len(locked)}) [rad or m]", locked))
    ranks = ", ".join(f"{rank} at {share:.0%}" for rank, share in report.ranks.items())
    blocks.append(
        f"Rank of J_r over {report.postures} random postures: {ranks} "
        f"(median of the smallest singular value {report.smallest_singular_value:.3g})"
    )
    if report.objects:
        title = f"Objects ({len(report.objects)})"
        blocks.append(_list(title, [_object(thing) for thing in report.objects]))
    blocks.append(_collision(report))
    if report.links_without_inertia:
        title = f"Links without inertia ({len(report.links_without_inertia)})"
        blocks.append(_list(title, report.links_without_inertia))
    if report.warnings:
        blocks.append(_list(f"Warnings ({len(report.warnings)})", list(report.warnings)))
    return "\n\n".join(blocks)


def _arm(arm: ArmReport) -> str:
    lines = [f"{arm.name}: {arm.urdf or 'a frame that stands still'}"]
    if arm.urdf is not None:
        lines.append(f"  {arm.root} -> {arm.tip}, {arm.joints} joints")
    lines.append(f"  base at {_vector(arm.base_xyz)} m, rpy {_vector(arm.base_rpy_deg)} deg")
    if any(arm.tool_xyz) or any(arm.tool_rpy_deg):
        lines.append(
            f"  tool at {_vector(arm.tool_xyz)} m, rpy {_vector(arm.tool_rpy_deg)} deg in the tip"
        )
    lines.append(f"  tool axis {_vector(arm.tool_axis)} in the tip")
    if arm.reach is not None:
        lines.append(f"  reach {arm.reach:.3f} m from its first joint")
    return "\n".join(lines)


def _joints(joints: Sequence[Joint]) -> str:
    rows: list[tuple[str, ...]]
    rows = [("joint", "type", "lower", "upper", "unit", "speed", "acceleration", "effort", "jerk")]
    for joint in joints:
        turns = joint.kind == "revolute"
        scale, unit = (_DEG, "deg") if turns else (1.0, "m")
        kind = "continuous" if joint.continuous else joint.kind
        lower, upper = (f"{bound * scale:.6g}" for bound in (joint.lower, joint.upper))
        speed = _known(joint.velocity, scale, f"{unit}/s")
        acceleration = _known(joint.acceleration, scale, f"{unit}/s^2")
        effort = _known(joint.effort, 1.0, "N m" if turns else "N")
        jerk = _known(joint.jerk, scale, f"{unit}/s^3")
        rows.append((joint.name, kind, lower, upper, unit, speed, acceleration, effort, jerk))
    if all(joint.jerk is None for joint in joints):  # few cells state one
        rows = [row[:-1] for row in rows]
    sides = "<<>><<<<<"[: len(rows[0])]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    line = "  ".join(f"{{:{side}{width}}}" for side, width in zip(sides, widths, strict=True))
    return "\n".join(line.format(*row).rstrip() for row in rows)


def _motion_limits(joints: Sequence[Joint]) -> str:
    """Say what a motion in time would lack, and the key of the cell file that brings it."""
    lines = []
    for word, key in MOTION_KEYS.items():
        unknown = [joint.name for joint in joints if getattr(joint, word) is None]
        which = "all joints" if len(unknown) == len(joints) else ", ".join(unknown)
        lines.append(f"  {key}: " + (f"missing for {which}" if unknown else "known"))
    return "\n".join(["Limits of motion, by key of the cell file:", *lines])


def _known(value: float | None, scale: float, unit: str) -> str:
    return "unknown" if value is None else f"{value * scale:.6g} {unit}"


def _object(thing: ObjectReport) -> str:
    """Return a line; a mesh in millimetres is the usual mistake, and shows in its size."""
    turned = f", rpy {_vector(thing.rpy_deg)} deg" if any(thing.rpy_deg) else ""
    line = f"{thing.name}: {thing.what} on {thing.on} at {_vector(thing.xyz)} m{turned}"
    line += f", extent {_vector(tuple(round(length, 3) for length in thing.size))} m"
    line += f", in {thing.pairs} pairs"
    if thing.allowed:
        line += f", may touch {', '.join(thing.allowed)}"
    if max(thing.size) > _HUGE:
        line += " (a mesh in millimetres? scale: 0.001)"
    return line


def _collision(report: CellReport) -> str:
    collision = report.collision
    lines = [f"Collision: {collision.bodies} bodies, {collision.pairs} pairs checked"]
    if collision.free_share is not None:
        lines.append(f"{collision.free_share:.0%} of the random postures are free of collision")
    else:
        reason = "bodies are missing" if collision.missing else "no two bodies can be compared"
        lines.append(f"clearance is unknown: {reason}")
    for title, items in (("missing", collision.missing), ("not checked", collision.dropped)):
        lines += _list(title, items).splitlines() if items else []
    return "\n  ".join(lines)


def _list(title: str, items: Sequence[str]) -> str:
    shown = [f"  {item}" for item in items[:_SHOWN]]
    if len(items) > _SHOWN:
        shown.append(f"  ... and {len(items) - _SHOWN} more (all with --json)")
    return "\n".join([f"{title}:", *shown])


def _vector(values: Sequence[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"

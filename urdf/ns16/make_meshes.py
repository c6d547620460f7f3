"""Draw the meshes of ns16.urdf: `python urdf/ns16/make_meshes.py`.

Every shape is ours, made of chamfered drums, blocks and hulls, and is placed on the joint axes that
the URDF states: change an origin there and the shapes follow. Written beside the URDF:
`meshes/<link>_<colour>.stl` for the eye and `meshes/<link>_hull_<k>.stl`, convex, for collisions.
A hull contains every visual part that it stands for.

Needs trimesh and scipy (both come with the `dev` extra).
"""

from __future__ import annotations

import math
import sys
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import trimesh
from trimesh.creation import revolve
from trimesh.transformations import euler_matrix, rotation_matrix

HERE = Path(__file__).resolve().parent
Z, Y = "z", "y"
GAP = 0.002  # between links that turn against each other [m]


def link_frames(urdf: Path) -> dict[str, np.ndarray]:
    """Return the pose (4, 4) of every link in the root link when all joints stand at zero."""
    robot = ET.parse(urdf).getroot()
    frames = {"base_link": np.eye(4)}
    for joint in robot.iter("joint"):  # parents come before children in this file
        origin = joint.find("origin").attrib
        step = euler_matrix(*(float(v) for v in origin["rpy"].split()), axes="sxyz")
        step[:3, 3] = [float(v) for v in origin["xyz"].split()]
        frames[joint.find("child").get("link")] = frames[joint.find("parent").get("link")] @ step
    return frames


def drum(
    axis: str,
    centre: tuple[float, float],
    span: tuple[float, float],
    radius: float | tuple[float, float],
    chamfer: float = 0.006,
    *,
    sides: int = 36,
) -> trimesh.Trimesh:
    """Return a drum or cone along world z or y, with chamfered rims.

    Args:
        axis: "z", with `centre` (x, y), or "y", with `centre` (x, z).
        centre: Where the axis crosses the other two coordinates [m].
        span: First and last coordinate along the axis [m].
        radius: One radius, or those at the two ends [m].
        chamfer: Width of the 45 degree rim [m].
        sides: Facets around.
    """
    low, high = radius if isinstance(radius, tuple) else (radius, radius)
    length = span[1] - span[0]
    rim = min(chamfer, 0.3 * length, 0.3 * low, 0.3 * high)
    profile = [
        (0, 0), (low - rim, 0), (low, rim), (high, length - rim), (high - rim, length), (0, length),
    ]  # fmt: skip
    body = revolve(profile, sections=sides)
    if axis == Y:
        body.apply_transform(rotation_matrix(-math.pi / 2, [1, 0, 0]))
        body.apply_translation([centre[0], span[0], centre[1]])
    else:
        body.apply_translation([centre[0], centre[1], span[0]])
    return body


def block(
    low: tuple[float, ...], high: tuple[float, ...], chamfer: float = 0.01
) -> trimesh.Trimesh:
    """Return a box between two corners [m] with every edge chamfered."""
    low, high = np.array(low), np.array(high)
    corners = []
    for k in range(3):
        inset = np.full(3, min(chamfer, 0.3 * float(np.min(high - low))))
        inset[k] = 0.0
        corners.append(trimesh.creation.box(bounds=[low + inset, high - inset]).vertices)
    return trimesh.convex.convex_hull(np.vstack(corners))


def hull(*bodies: trimesh.Trimesh) -> trimesh.Trimesh:
    """Return the convex hull of several bodies."""
    return trimesh.convex.convex_hull(np.vstack([b.vertices for b in bodies]))


@dataclass
class Link:
    """What is drawn on one link, in world coordinates with all joints at zero."""

    parts: list[tuple[str, int, trimesh.Trimesh]] = field(default_factory=list)

    def add(self, colour: str, group: int, *bodies: trimesh.Trimesh) -> None:
        """Draw `bodies` in `colour` and let hull number `group` contain them."""
        self.parts += [(colour, group, body) for body in bodies]

    def visuals(self) -> dict[str, trimesh.Trimesh]:
        """Return one mesh per colour."""
        colours = sorted({colour for colour, _, _ in self.parts})
        return {
            c: trimesh.util.concatenate([b for colour, _, b in self.parts if colour == c])
            for c in colours
        }

    def hulls(self) -> list[trimesh.Trimesh]:
        """Return one convex body per group."""
        groups = sorted({group for _, group, _ in self.parts})
        return [hull(*(b for _, group, b in self.parts if group == g)) for g in groups]


def draw(at: dict[str, np.ndarray]) -> dict[str, Link]:
    """Return the bodies of every link on the axes given by `at`."""
    robot = {name: Link() for name in at if name != "flange"}
    p = {name: frame[:3, 3] for name, frame in at.items()}
    _draw_stand(robot, p)
    _draw_arm(robot, p)
    _draw_wrist(robot, p)
    return robot


def _draw_stand(robot: dict[str, Link], p: dict[str, np.ndarray]) -> None:
    """Draw base and turret."""
    floor = p["link_1"][2]  # plane between base and turret
    shoulder = p["link_2"][[0, 2]]
    side = p["link_2"][1]  # plane between turret and upper arm

    base = robot["base_link"]
    base.add("graphite", 0, block((-0.28, -0.28, 0.0), (0.28, 0.28, 0.035)))
    for x in (-0.23, 0.23):
        for y in (-0.23, 0.23):
            base.add("steel", 0, drum(Z, (x, y), (0.03, 0.052), 0.024, sides=6))
    base.add("red", 0, drum(Z, (0, 0), (0.03, floor - 0.03), (0.255, 0.215), 0.012, sides=48))
    base.add("graphite", 0, drum(Z, (0, 0), (floor - 0.034, floor - GAP), 0.228, sides=48))
    base.add("graphite", 0, block((-0.33, -0.11, 0.03), (-0.18, 0.11, 0.19)))
    for y in (-0.05, 0.05):
        base.add("steel", 0, _along_x((-0.345, y, 0.115), 0.03, 0.028))

    turret = robot["link_1"]
    foot = drum(Z, (0, 0), (floor + GAP, floor + 0.06), 0.222, 0.012, sides=48)
    column = drum(Z, (0.02, 0.01), (floor + 0.055, floor + 0.10), 0.2, 0.02)
    boss = drum(Y, shoulder, (side + 0.045, 0.12), 0.15, 0.015)
    turret.add("red", 0, foot, hull(column, boss))
    turret.add("graphite", 0, drum(Y, shoulder, (side + GAP, side + 0.05), 0.142))
    turret.add("graphite", 1, drum(Y, shoulder, (0.115, 0.15), 0.11))
    turret.add("graphite", 1, drum(Y, shoulder, (0.145, 0.31), 0.078, 0.012))
    turret.add("steel", 1, drum(Y, shoulder, (0.305, 0.33), 0.06))
    turret.add(
        "red", 2, block((-0.215, -0.085, floor + 0.05), (-0.045, 0.105, floor + 0.12), 0.015)
    )
    turret.add("graphite", 2, drum(Z, (-0.125, 0.01), (floor + 0.115, floor + 0.31), 0.075, 0.012))
    turret.add("steel", 2, drum(Z, (-0.125, 0.01), (floor + 0.305, floor + 0.33), 0.058))


def _draw_arm(robot: dict[str, Link], p: dict[str, np.ndarray]) -> None:
    """Draw upper arm and elbow housing, which meet in the same plane as turret and upper arm."""
    shoulder, elbow = p["link_2"][[0, 2]], p["link_3"][[0, 2]]
    side = p["link_2"][1]
    fore, neck = p["link_4"][:2], p["link_4"][2]  # vertical axis of the forearm, where it starts

    upper = robot["link_2"]
    outer = side - 0.125
    upper.add(
        "red", 0,
        hull(
            drum(Y, shoulder, (outer, side - GAP), (0.138, 0.15), 0.015),
            drum(Y, elbow, (outer + 0.02, side - GAP), (0.108, 0.118), 0.015),
        ),
    )  # fmt: skip
    upper.add("graphite", 0, drum(Y, shoulder, (outer - 0.014, outer + 0.01), 0.105))
    upper.add("graphite", 0, drum(Y, elbow, (outer + 0.006, outer + 0.03), 0.08))
    upper.add("steel", 0, drum(Y, shoulder, (outer - 0.02, outer), 0.05))
    upper.add("steel", 0, drum(Y, elbow, (outer, outer + 0.02), 0.04))
    along = (elbow - shoulder) / np.linalg.norm(elbow - shoulder)
    rib = [shoulder + 0.17 * along, elbow - 0.135 * along]
    upper.add(
        "graphite", 0,
        hull(*(drum(Y, c, (outer + d, outer + d + 0.02), r) for c, d, r in zip(
            rib, (-0.006, 0.008), (0.075, 0.06), strict=True))),
    )  # fmt: skip

    housing = robot["link_3"]
    pin = drum(Y, elbow, (side + 0.035, 0.098), 0.118, 0.015)
    sleeve = drum(Z, fore, (elbow[1] - 0.10, neck - 0.045), 0.098, 0.012)
    housing.add("red", 0, hull(pin, sleeve))
    housing.add("graphite", 0, drum(Y, elbow, (side + GAP, side + 0.04), 0.11))
    housing.add("steel", 0, drum(Y, elbow, (0.092, 0.102), 0.06))
    housing.add("graphite", 0, drum(Z, fore, (neck - 0.05, neck - GAP), 0.1))
    housing.add("graphite", 1, drum(Z, fore, (elbow[1] - 0.125, elbow[1] - 0.095), 0.102))
    for k in range(3):
        a = math.radians(120 * k)
        c = (fore[0] + 0.054 * math.cos(a), fore[1] + 0.054 * math.sin(a))
        housing.add(
            "graphite", 1, drum(Z, c, (elbow[1] - 0.30, elbow[1] - 0.12), 0.042, 0.008, sides=24)
        )
        housing.add("steel", 1, drum(Z, c, (elbow[1] - 0.315, elbow[1] - 0.295), 0.03, sides=24))


def _draw_wrist(robot: dict[str, Link], p: dict[str, np.ndarray]) -> None:
    """Draw forearm, hand and flange; the face of the flange is the plane of the tip."""
    fore = p["link_4"][:2]
    neck, wrist, tip = p["link_4"][2], p["link_5"][2], p["flange"][2]

    forearm = robot["link_4"]
    forearm.add("red", 0, drum(Z, fore, (neck + GAP, neck + 0.05), 0.096, 0.01))
    forearm.add("red", 0, drum(Z, fore, (neck + 0.045, wrist - 0.12), (0.09, 0.074), 0.004))
    forearm.add("red", 0, drum(Z, fore, (wrist - 0.125, wrist - 0.085), 0.082, 0.01))
    for s in (-1, 1):
        inner, rim = sorted((s * 0.052, s * 0.084)), sorted((s * 0.08, s * 0.091))
        forearm.add(
            "red", 0,
            hull(
                drum(Y, (fore[0], wrist), tuple(inner), 0.066, 0.008),
                block((fore[0] - 0.055, inner[0], wrist - 0.11),
                      (fore[0] + 0.055, inner[1], wrist - 0.09), 0.004),
            ),
        )  # fmt: skip
        forearm.add("graphite", 0, drum(Y, (fore[0], wrist), tuple(rim), 0.048, 0.003))

    hand = robot["link_5"]
    hand.add("steel", 0, drum(Y, (fore[0], wrist), (-0.05, 0.05), 0.06, 0.006))
    hand.add("graphite", 0, drum(Z, fore, (wrist + 0.03, tip - 0.045), 0.048, 0.004))
    hand.add("red", 0, drum(Z, fore, (tip - 0.05, tip - 0.035 - GAP), 0.051, 0.003))

    disc = robot["link_6"]
    disc.add("steel", 0, drum(Z, fore, (tip - 0.035, tip - 0.001), 0.0475, 0.003))
    disc.add(
        "red",
        0,
        block((fore[0] + 0.043, -0.007, tip - 0.03), (fore[0] + 0.052, 0.007, tip - 0.004), 0.002),
    )
    disc.add("graphite", 0, drum(Z, fore, (tip - 0.004, tip), 0.016, 0.0005, sides=24))
    for k in range(6):
        a = math.radians(60 * k + 30)
        c = (fore[0] + 0.0325 * math.cos(a), fore[1] + 0.0325 * math.sin(a))
        disc.add("graphite", 0, drum(Z, c, (tip - 0.004, tip), 0.0045, 0.0005, sides=10))


def build(urdf: Path = HERE / "ns16.urdf") -> dict[str, trimesh.Trimesh]:
    """Return all meshes by file name, each in the frame of its link."""
    frames = link_frames(urdf)
    meshes = {}
    for name, link in draw(frames).items():
        named = {f"{name}_{colour}.stl": body for colour, body in link.visuals().items()}
        named |= {f"{name}_hull_{k}.stl": body for k, body in enumerate(link.hulls())}
        for file, body in named.items():
            body.apply_transform(np.linalg.inv(frames[name]))
            meshes[file] = body
    return meshes


def _along_x(start: tuple[float, float, float], length: float, radius: float) -> trimesh.Trimesh:
    body = drum(Z, (0, 0), (0, length), radius, 0.003, sides=24)
    body.apply_transform(rotation_matrix(math.pi / 2, [0, 1, 0]))
    body.apply_translation(start)
    return body


def main() -> int:
    """Write the meshes and say what they weigh."""
    folder = HERE / "meshes"
    folder.mkdir(exist_ok=True)
    size = 0
    for file, body in build().items():
        size += (folder / file).write_bytes(body.export(file_type="stl"))
    sys.stdout.write(f"{len(list(folder.glob('*.stl')))} meshes, {size / 1e3:.0f} kB\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

"""Models and problems that the engine's tests share."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.indices import Index, force
from dualarm_pin.problem import Problem
from dualarm_pin.rows import Row

# xyz and rpy of joint_1 .. joint_6 and of the flange, each joint about its own z
_NS16 = [
    ((0, 0, 0.251), (pi, 0, 0)),
    ((0.3, 0.101, -0.349), (-pi / 2, 0, pi)),
    ((0, 0.7, 0), (pi, 0, pi / 2)),
    ((0.238, 0.185, -0.101), (-pi / 2, 0, pi / 2)),
    ((0, 0, -0.386), (-pi / 2, pi / 2, 0)),
    ((0.106, 0, 0), (pi / 2, 0, -pi / 2)),
    ((0, 0, -0.029), (pi, 0, pi)),
]
TABLE_I = np.deg2rad([[-60, 60], [-45, 90], [-150, 45], [-90, 90], [-90, 90], [-90, 90]])


class BareCell:
    """A Pinocchio model and two frames, as far as a problem needs a cell."""

    def __init__(
        self, model: Any, e1: int, e2: int, joint_map: Any = None, joint_offset: Any = None
    ) -> None:
        self.model, self.e1, self.e2, self.name = model, e1, e2, "bare"
        self.joint_map = np.eye(model.nv) if joint_map is None else joint_map
        self.joint_offset = np.zeros(model.nv) if joint_offset is None else joint_offset
        self.n = self.joint_map.shape[1]
        self.same_order = joint_map is None and joint_offset is None
        self.joint_names = tuple(f"joint {k}" for k in range(self.n))

    def model_q(self, q: Any) -> Any:
        return self.joint_map @ np.asarray(q, dtype=float) + self.joint_offset

    def data(self) -> Any:
        return self.model.createData()


def ns16_pair(base2: Any = None) -> tuple[Any, int, int]:
    """Return (model, e1, e2) of the paper's cell."""
    model, tips = pin.Model(), []
    if base2 is None:
        base2 = pin.SE3(pin.utils.rotate("z", pi), np.array([2.5, 0.0, 0.0]))
    for arm, base in (("arm1", pin.SE3.Identity()), ("arm2", base2)):
        parent, before = 0, base
        for number, (xyz, rpy) in enumerate(_NS16, 1):
            placement = before * pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(xyz, dtype=float))
            before = pin.SE3.Identity()
            if number <= 6:
                name = f"{arm}/joint_{number}"
                parent = model.addJoint(parent, pin.JointModelRZ(), placement, name)
            else:
                frame = pin.Frame(f"{arm}/flange", parent, placement, pin.FrameType.BODY)
                tips.append(model.addFrame(frame))
    return model, tips[0], tips[1]


def ns16_cell(base2: Any = None) -> BareCell:
    return BareCell(*ns16_pair(base2))


def corner(
    points: tuple[int, int, int] = (13, 5, 13), side: float = 0.15, fillet: float = 0.01
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (h, 3) and unit tangents (h, 3) of the paper's corner."""
    first, bend, last = points
    inner = side - fillet
    angle = 0.5 * pi * np.arange(1, bend + 1) / (bend + 1)
    x = [np.full(first, side), inner + fillet * np.cos(angle), np.linspace(inner, 0.0, last)]
    y = [np.linspace(0.0, inner, first), inner + fillet * np.sin(angle), np.full(last, side)]
    position = np.stack([np.concatenate(x), np.concatenate(y), np.full(sum(points), 0.3)], axis=1)
    tangent = np.zeros_like(position)
    tangent[:first, 1], tangent[first + bend :, 0] = 1.0, -1.0
    tangent[first : first + bend, :2] = np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    return position, tangent


def paper_problem(
    index: Index | None = None,
    smoothness: float = 3.0,
    points: tuple[int, int, int] = (13, 5, 13),
    **changes: Any,
) -> Problem:
    """Return the paper's task on the whole path: P31 by default."""
    position, tangent = corner(points)
    h = len(position)
    stated: dict[str, Any] = {
        "rotation": np.tile(np.diag([1.0, -1.0, -1.0]), (h, 1, 1)),
        "lower": np.tile(TABLE_I[:, 0], 2),
        "upper": np.tile(TABLE_I[:, 1], 2),
        "u": np.hstack([tangent, np.zeros((h, 3))]),
        "link_weight": np.full(h - 1, smoothness),
    }
    cell = changes.pop("cell", None) or ns16_cell()
    of_points = {name: changes.pop(name) for name in ("linear",) if name in changes}
    problem = Problem.of(cell, index or force(), position, **(stated | changes))
    return problem.with_points(**of_points)


def random_pair(seed: int, joints: tuple[int, int] = (5, 5), prismatic: float = 0.25) -> Any:
    """Return (model, e1, e2): two arms of random joints on random axes, random tool frames."""
    rng = np.random.default_rng(seed)
    model, tips = pin.Model(), []
    for arm, count in zip(("arm1", "arm2"), joints, strict=True):
        parent = 0
        for number in range(count):
            axis = rng.normal(size=3)
            axis /= np.linalg.norm(axis)
            if rng.uniform() < prismatic:
                joint = pin.JointModelPrismaticUnaligned(axis)
            elif rng.uniform() < 0.3:
                joint = [pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ][rng.integers(3)]()
            else:
                joint = pin.JointModelRevoluteUnaligned(axis)
            parent = model.addJoint(parent, joint, _random_place(rng), f"{arm}/{number}")
        frame = pin.Frame(f"{arm}/tip", parent, _random_place(rng), pin.FrameType.BODY)
        tips.append(model.addFrame(frame))
    return model, tips[0], tips[1]


def _random_place(rng: np.random.Generator) -> Any:
    turn = pin.Quaternion(rng.normal(size=4)).normalized()
    return pin.SE3(turn, rng.uniform(-0.4, 0.4, 3))


def random_problem(
    seed: int, index: Index, k: int = 4, mimic: bool = True, rows: tuple[Row, ...] = ()
) -> Problem:
    """Return a problem on a random pair with every kind of point, weight and link.

    With `mimic` the model has ten joints and nine variables: two joints follow one variable, one
    of them scaled and shifted, one joint stands still, and one variable moves nothing.
    """
    rng = np.random.default_rng(seed)
    model, e1, e2 = random_pair(seed)
    n = model.nv
    if mimic:
        joint_map = np.zeros((n, n - 1))
        joint_map[: n - 2, : n - 2] = np.eye(n - 2)
        joint_map[n - 1, 1] = -0.7
        offset = np.where(np.arange(n) >= n - 2, 0.3, 0.0)
        n -= 1
    else:
        joint_map, offset = np.eye(n), np.zeros(n)
    rotation = np.array([_random_place(rng).rotation for _ in range(k)])
    problem = Problem.of(
        BareCell(model, e1, e2, joint_map, offset),
        index,
        rng.normal(size=(k, 3)),
        rotation,
        lower=np.full(n, -2.0),
        upper=rng.uniform(1.5, 2.5, n),
        pose_rows=[(6, 5, 3)[i % 3] for i in range(k)],
        spin_axis=rng.normal(size=3),
        u=rng.normal(size=(k, 6)),
        link_weight=rng.uniform(0.0, 3.0, k - 1),
        metric=rng.uniform(0.5, 2.0, (k - 1, n)),
        index_weight=rng.uniform(0.0, 2.0, k),
        rows=rows,
    )
    weights = np.concatenate([[1.3], problem.links.weight[:-1], [0.4]])
    linked = problem.subset(range(k), weights, rng.normal(size=n), rng.normal(size=n))
    return linked.with_points(linear=rng.normal(size=(k, n)))

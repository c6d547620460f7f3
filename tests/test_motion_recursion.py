"""The fastest law against closed forms, a linear programme at every point, and another library."""

from __future__ import annotations

import platform
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import linprog

from dualarm_pin.cell import Cell
from dualarm_pin.motion.limits import Limits
from dualarm_pin.motion.recursion import fastest
from dualarm_pin.motion.time_optimal import limit_rows
from dualarm_pin.motion.torque import Torques

N, JOINTS = 300, 12


LINUX = pytest.mark.xfail(
    (sys.platform, platform.machine()) != ("linux", "x86_64"),
    reason="toppra has wheels for Linux x86_64 alone",
    run=False,
)


def duration(s: np.ndarray, x: np.ndarray) -> float:
    speed = np.sqrt(x)
    return float(np.sum(2.0 * np.diff(s) / (speed[1:] + speed[:-1])))


def two_sided(a: np.ndarray, b: np.ndarray, limit: np.ndarray) -> tuple[np.ndarray, ...]:
    return (
        np.concatenate([a, -a], axis=1),
        np.concatenate([b, -b], axis=1),
        np.broadcast_to(np.concatenate([limit, limit]), (len(a), 2 * len(limit))).copy(),
    )


def random_path(seed: int):
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(int(rng.integers(4, 9)), JOINTS))
    places = np.linspace(0.0, 1.0, len(way))
    spline = CubicSpline(places, way)
    s = np.linspace(0.0, 1.0, N)
    velocity, acceleration = rng.uniform(1, 3, JOINTS), rng.uniform(2, 10, JOINTS)
    rows = two_sided(spline(s, 1), spline(s, 2), acceleration)
    most = np.min((velocity / np.abs(spline(s, 1))) ** 2, axis=1)
    return s, rows, most, (places, way, velocity, acceleration)


@pytest.mark.parametrize("most", [100.0, 0.25])
def test_a_straight_line_is_the_double_integrator(most: float) -> None:
    s = np.linspace(0.0, 1.0, N + 1)
    one = np.ones((N + 1, 1))
    code, x = fastest(s, two_sided(one, 0 * one, np.array([2.0])), np.full(N + 1, most), True)
    top = np.sqrt(min(most, 2.0))
    expected = 2.0 * top / 2.0 + (1.0 - top**2 / 2.0) / top  # ramps, and what is left at the top
    assert code == -1
    assert duration(s, x) == pytest.approx(expected, rel=1e-3)
    assert np.allclose(x, np.minimum(np.minimum(4 * s, 4 * (1 - s)), most), atol=1e-9)


def test_a_ring_is_run_at_the_speed_its_curvature_allows() -> None:
    s = np.linspace(0.0, 3.0, 3001)
    d1 = np.stack([-np.sin(s), np.cos(s)], axis=1)
    d2 = np.stack([-np.cos(s), -np.sin(s)], axis=1)
    code, x = fastest(s, two_sided(d1, d2, np.ones(2)), np.full(len(s), 1e9), True)
    u = np.diff(x) / (2 * np.diff(s))
    use = np.abs(d1[:-1] * u[:, None] + d2[:-1] * x[:-1, None])
    assert code == -1
    assert use.max() <= 1.0 + 1e-9
    assert np.median(use.max(axis=1)) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_every_reachable_speed_is_that_of_a_linear_programme(seed: int) -> None:
    s, rows, most, _ = random_path(seed)
    keep = np.arange(0, N, 6)
    s, most, rows = s[keep], most[keep], tuple(row[keep].copy() for row in rows)
    code, x = fastest(s, rows, most, True)
    a, b, g = rows
    reach = np.zeros(len(s))
    for i in range(len(s) - 2, -1, -1):
        ds = s[i + 1] - s[i]
        left = np.concatenate([a[i], a[i + 1] + 2 * ds * b[i + 1], [2 * ds, -2 * ds]])
        right = np.concatenate([b[i], b[i + 1], [1.0, -1.0]])
        limit = np.concatenate([g[i], g[i + 1], [reach[i + 1], 0.0]])
        best = linprog(
            [0, -1], np.stack([left, right], 1), limit, bounds=[(None, None), (0, most[i])]
        )
        reach[i] = best.x[1]
    forward = np.zeros(len(s))
    for i in range(len(s) - 1):
        ds = s[i + 1] - s[i]
        left = np.concatenate([a[i], a[i + 1] + 2 * ds * b[i + 1], [2 * ds]])
        limit = np.concatenate(
            [
                g[i] - b[i] * forward[i],
                g[i + 1] - b[i + 1] * forward[i],
                [reach[i + 1] - forward[i]],
            ]
        )
        best = linprog([-1], left[:, None], limit, bounds=[(None, None)])
        forward[i + 1] = forward[i] + 2 * ds * best.x[0]
    assert code == -1
    assert np.allclose(x, forward, rtol=1e-6, atol=1e-9)


def by_toppra(places, way, s, velocity, acceleration, *more):
    """Return the duration that toppra finds on a spline from rest to rest."""
    toppra = pytest.importorskip("toppra")
    toppra.setup_logging("ERROR")
    limits = [
        toppra.constraint.JointVelocityConstraint(velocity),
        toppra.constraint.JointAccelerationConstraint(acceleration, discretization_scheme=1),
    ]
    theirs = toppra.algorithm.TOPPRA(
        [*limits, *more], toppra.SplineInterpolator(places, way), gridpoints=s
    )
    theirs.compute_parameterization(0.0, 0.0)
    return duration(s, theirs.problem_data.sd_vec**2)


@LINUX
def test_durations_are_those_of_toppra_on_thirty_paths() -> None:
    for seed in range(30):
        s, rows, most, (places, way, velocity, acceleration) = random_path(seed)
        code, x = fastest(s, rows, most, True)
        assert code == -1
        expected = by_toppra(places, way, s, velocity, acceleration)
        assert duration(s, x) == pytest.approx(expected, rel=5e-3)


def with_torque(cell: Cell, seed: int):
    """Return a random path of a cell's joints, and limits of which torque is one that binds."""
    rng = np.random.default_rng(seed)
    middle, half = (cell.lower + cell.upper) / 2, (cell.upper - cell.lower) / 2
    way = middle + 0.5 * half * rng.uniform(-1, 1, (int(rng.integers(4, 9)), cell.n))
    places = np.linspace(0.0, 1.0, len(way))
    curve = SimpleNamespace(
        at=CubicSpline(places, way),
        relative=SimpleNamespace(direction=lambda s: np.zeros((len(s), 6))),
    )
    s = np.linspace(0.0, 1.0, N)
    q, still = curve.at(s), np.zeros((N, cell.n))
    load = np.abs(Torques(cell, 0.0).static(q, np.zeros((N, 6)))).max(axis=0)
    inertia = np.abs(Torques(cell, 0.0).moving(q, still, curve.at(s, 1))).max(axis=0)
    limits = Limits(
        tuple(map(str, range(cell.n))),
        velocity=rng.uniform(1, 3, cell.n),
        acceleration=rng.uniform(5, 20, cell.n),
        jerk=np.full(cell.n, np.inf),
        torque=load + rng.uniform(0.05, 0.3, cell.n) * np.maximum(inertia, load.max() / 1000),
        kinds=("velocity", "acceleration", "torque"),
    )
    return s, (places, way), curve, limits


@LINUX
def test_durations_with_torque_are_those_of_toppra_on_twelve_paths(cell: Cell) -> None:
    toppra = pytest.importorskip("toppra")
    assert not cell.massless_joints
    model, data, to_model = cell.model, cell.data(), cell.joint_map.T

    def torque(q, velocity, acceleration):  # not by rnea, which ours is by
        q, v = q @ to_model + cell.joint_offset, velocity @ to_model
        inertia = pin.crba(model, data, q)
        inertia = np.triu(inertia) + np.triu(inertia, 1).T
        rest = pin.nonLinearEffects(model, data, q, v)
        return (inertia @ (acceleration @ to_model) + rest) @ cell.joint_map

    slower = []
    for seed in range(12):
        s, (places, way), curve, limits = with_torque(cell, seed)
        most = np.min((limits.velocity / np.abs(curve.at(s, 1))) ** 2, axis=1)
        code, x = fastest(s, limit_rows(curve, limits, Torques(cell, 0.0), s), most, True)
        free = replace(limits, kinds=("velocity", "acceleration"))
        _, light = fastest(s, limit_rows(curve, free, Torques(cell, 0.0), s), most, True)
        assert code == -1
        most_torque = toppra.constraint.JointTorqueConstraint(
            torque,
            np.stack([-limits.torque, limits.torque], axis=1),
            np.zeros(cell.n),
            discretization_scheme=1,
        )
        expected = by_toppra(places, way, s, limits.velocity, limits.acceleration, most_torque)
        assert duration(s, x) == pytest.approx(expected, rel=1e-4)
        slower.append(duration(s, x) / duration(s, light))
    assert min(slower) > 1.05  # torque holds every one of them back


def test_a_row_that_nothing_keeps_names_its_point() -> None:
    s = np.linspace(0.0, 1.0, 11)
    one = np.ones((11, 1))
    a, b, g = two_sided(one, 0 * one, np.array([1.0]))
    g[4] = -1.0
    code, _ = fastest(s, (a, b, g), np.full(11, 1.0), True)
    assert code in (3, 4)

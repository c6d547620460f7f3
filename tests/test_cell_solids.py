"""Distances of meshes as they are: a body that is wholly inside another has met it."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from dualarm_pin.cell.solids import Solids, winding

Array = NDArray[np.float64]
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def _box(half: float, sides: int = 6) -> tuple[Array, NDArray[np.int64]]:
    corners = half * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = [[a, b, c] for p, q, r, s in _SIDES[:sides] for a, b, c in ((p, q, r), (p, r, s))]
    return corners.astype(float), np.array(faces)


def _mesh(half: float, sides: int = 6) -> coal.BVHModelOBBRSS:
    corners, faces = _box(half, sides)
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(faces), len(corners))
    mesh.addVertices(corners)
    mesh.addTriangles(faces)
    mesh.endModel()
    return mesh


def _distance(
    first: coal.CollisionGeometry,
    second: coal.CollisionGeometry,
    away: float,
    hulls: float = -0.1,
    most: float = np.inf,
) -> float:
    bodies = pin.GeometryModel()
    for name, shape in (("first", first), ("second", second)):
        bodies.addGeometryObject(pin.GeometryObject(name, 0, pin.SE3.Identity(), shape))
    bodies.addCollisionPair(pin.CollisionPair(0, 1))
    scene = bodies.createData()
    turn = pin.exp3(np.array([0.3, -0.2, 0.5]))
    scene.oMg[0] = pin.SE3(turn, np.array([1.0, 2.0, 3.0]))
    scene.oMg[1] = scene.oMg[0] * pin.SE3(np.eye(3), np.array([away, 0.0, 0.0]))
    return float(Solids(bodies).distance(0, scene, hulls, most).min_distance)


def test_a_mesh_inside_another_has_met_it_whichever_is_first() -> None:
    small, large = _mesh(0.1), _mesh(1.0)
    assert _distance(small, large, 0.05) <= 0.0
    assert _distance(large, small, 0.05) <= 0.0
    assert _distance(small, large, 1.5) == pytest.approx(0.4)


def test_a_shape_inside_a_mesh_has_met_it_and_a_mesh_inside_a_shape() -> None:
    for shape in (coal.Sphere(0.2), coal.Box(0.2, 0.2, 0.2)):
        assert _distance(shape, _mesh(1.0), 0.3) <= 0.0
        assert _distance(_mesh(1.0), shape, 0.3) <= 0.0
    assert _distance(coal.Sphere(1.0), _mesh(0.1), 0.3) <= 0.0


def test_what_lies_in_an_open_bin_has_not_met_it() -> None:
    assert _distance(_mesh(0.1), _mesh(1.0, sides=5), 0.0) > 0.5
    corners, faces = _box(1.0, 5)
    assert winding(corners[faces], np.zeros(3)) == pytest.approx(5.0 / 6.0)


def test_a_distance_above_what_matters_is_given_as_that() -> None:
    small, large = _mesh(0.1), _mesh(1.0)
    assert _distance(small, large, 1.5, hulls=0.4, most=0.2) == 0.2
    assert _distance(small, large, 1.2, hulls=0.1, most=0.2) == pytest.approx(0.1)


def test_what_two_rays_leave_freely_is_outside_and_no_angle_is_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("dualarm_pin.cell.solids.winding", lambda *_: pytest.fail("measured"))
    assert _distance(_mesh(0.1), _mesh(1.0, sides=4), 0.0) > 0.5

"""Our NS16: kinematics against published figures, shapes fit for seeing and for collisions."""

import json
import runpy
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.files.resources import urdf_folder

trimesh = pytest.importorskip("trimesh")

FOLDER = urdf_folder() / "ns16"
URDF = FOLDER / "ns16.urdf"
CASES = json.loads((Path(__file__).parent / "data" / "ns16_reference.json").read_text())["cases"]
TABLE_I = np.radians([[-60, -45, -150, -90, -90, -90], [60, 90, 45, 90, 90, 90]])


@pytest.fixture(scope="module")
def model():
    return pin.buildModelFromUrdf(str(URDF))


def flange(model, q):
    data = model.createData()
    pin.forwardKinematics(model, data, np.asarray(q, dtype=float))
    return pin.updateFramePlacement(model, data, model.getFrameId("flange")).copy()


@pytest.mark.parametrize(
    ("q_deg", "position", "rotation", "digits"),
    [
        ((0, 0, 0, 0, 0, 0), (0.115, 0, 2.059), np.eye(3), 1e-12),
        ((0, 0, -90, 0, 0, 0), (1.059, 0, 1.485), [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], 1e-12),
        ((0, 0, -90, 0, 90, 0), (0.924, 0, 1.350), np.diag([-1, 1, -1]), 1e-12),
        ((30, 20, -100, 40, -50, 60), (1.14787698, -0.58596892, 1.13121899), None, 6e-9),
    ],
)
def test_check_poses(model, q_deg, position, rotation, digits):
    tip = flange(model, np.radians(q_deg))
    np.testing.assert_allclose(tip.translation, position, atol=digits)
    if rotation is not None:
        np.testing.assert_allclose(tip.rotation, rotation, atol=1e-12)


def test_limits_are_the_full_range_and_speed_is_unknown(model):
    lower = np.radians([-180, -50, -170, -360, -180, -360])
    upper = np.radians([180, 95, 110, 360, 180, 360])
    np.testing.assert_allclose(model.lowerPositionLimit, lower, atol=1e-15)
    np.testing.assert_allclose(model.upperPositionLimit, upper, atol=1e-15)
    assert not model.velocityLimit.any()
    assert not model.effortLimit.any()


@pytest.mark.parametrize("case", CASES)
def test_relative_jacobian(model, case):
    """J_r of the pair 2.5 m apart, from two single arms: eq. (10) and (11)."""
    q1, q2 = np.split(np.array(case["q"]), 2)
    base2 = pin.SE3(np.diag([-1.0, -1.0, 1.0]), np.array([2.5, 0, 0]))
    frame = model.getFrameId("flange")
    tip1, tip2 = flange(model, q1), base2 * flange(model, q2)
    relative = tip1.inverse() * tip2
    data = model.createData()
    J1 = pin.computeFrameJacobian(model, data, q1, frame, pin.LOCAL).copy()
    J2 = pin.computeFrameJacobian(model, data, q2, frame, pin.LOCAL).copy()
    body = np.hstack([-relative.inverse().toActionMatrix() @ J1, J2])
    J_r = np.vstack([relative.rotation @ body[:3], relative.rotation @ body[3:]])
    np.testing.assert_allclose(relative.translation, case["position"], atol=1e-9)
    np.testing.assert_allclose(relative.rotation, case["rotation"], atol=1e-9)
    np.testing.assert_allclose(J_r, case["J_r"], atol=1e-9)


def test_yourdfpy_agrees(model):
    yourdfpy = pytest.importorskip("yourdfpy")
    robot = yourdfpy.URDF.load(str(URDF), load_meshes=False)
    for q in np.random.default_rng(1).uniform(*TABLE_I, (10, 6)):
        robot.update_cfg(q)
        T = robot.get_transform("flange", "base_link")
        np.testing.assert_allclose(T, flange(model, q).homogeneous, atol=1e-12)


@pytest.mark.parametrize("file", sorted(FOLDER.glob("meshes/*.stl")), ids=lambda f: f.stem)
def test_meshes_are_closed(file):
    mesh = trimesh.load(file)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    if "_hull_" in file.name:
        assert mesh.convex_hull.volume == pytest.approx(mesh.volume, rel=1e-4)


def test_every_mesh_is_used_and_small(model):
    used = set()
    for kind in (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION):
        geometry = pin.buildGeomFromUrdf(model, str(URDF), kind, package_dirs=[str(FOLDER)])
        used |= {Path(item.meshPath).name for item in geometry.geometryObjects}
    files = list((FOLDER / "meshes").iterdir())
    assert used == {file.name for file in files}
    assert sum(file.stat().st_size for file in files) < 1_000_000


def test_script_draws_the_committed_meshes():
    drawn = runpy.run_path(str(FOLDER / "make_meshes.py"))["build"]()
    assert set(drawn) == {file.name for file in (FOLDER / "meshes").iterdir()}
    for name, mesh in drawn.items():
        kept = trimesh.load(FOLDER / "meshes" / name)
        np.testing.assert_allclose(mesh.bounds, kept.bounds, atol=1e-6, err_msg=name)
        assert mesh.volume == pytest.approx(kept.volume, rel=1e-4), name
        assert len(mesh.faces) == len(kept.faces), name


def test_hulls_contain_what_is_drawn():
    drawn = runpy.run_path(str(FOLDER / "make_meshes.py"))
    for name, link in drawn["draw"](drawn["link_frames"](URDF)).items():
        hulls = link.hulls()
        for _, group, body in link.parts:
            hull = hulls[group]
            inside = hull.face_normals @ body.vertices.T
            depth = np.einsum("ij,ij->i", hull.face_normals, hull.triangles[:, 0])
            assert np.all(inside <= depth[:, None] + 1e-9), name


def test_free_of_itself_in_the_range_of_the_paper(model):
    """Links two joints apart touch in fewer than 1 % of the postures of Table I."""
    geometry = pin.buildGeomFromUrdf(
        model, str(URDF), pin.GeometryType.COLLISION, package_dirs=[str(FOLDER)]
    )
    items = geometry.geometryObjects
    for item in items:
        item.geometry.buildConvexHull(False, "Qt")
        item.geometry = item.geometry.convex
    for i, first in enumerate(items):
        for k in range(i + 1, len(items)):
            if abs(first.parentJoint - items[k].parentJoint) > 1:
                geometry.addCollisionPair(pin.CollisionPair(i, k))
    data, geometry_data = model.createData(), geometry.createData()
    postures = np.random.default_rng(0).uniform(*TABLE_I, (1000, 6))
    touching = [
        pin.computeCollisions(model, data, geometry, geometry_data, q, True) for q in postures
    ]
    assert np.mean(touching) < 0.01
    folded = np.radians([0, 0, 0, 0, 175, 0])  # hand turned back into the forearm: must be seen
    assert pin.computeCollisions(model, data, geometry, geometry_data, folded, True)

"""The page without a browser: what is in it, what is refused, what is escaped."""

import base64
import gzip
import json
import re

import coal
import numpy as np
import pinocchio as pin
import pytest
from answers import answer, answers, task
from ns16_pair import corner, motions, pair

from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.meshes.triangles import triangles_of
from dualarm_pin.show import Scene, player_page, posture_page, write_player


def scene():
    scene = Scene()
    for label, trajectory in answers().items():
        scene.add(label, task(), trajectory)
    return scene


def unpack(data):
    length = int.from_bytes(data[:4], "little")
    head, rest = json.loads(data[4 : 4 + length]), data[4 + length :]

    def array(ref):
        kind = np.dtype("<" + ref["type"])
        count = int(np.prod(ref["shape"]))
        return np.frombuffer(rest, kind, count, ref["at"]).reshape(ref["shape"])

    return head, array


def poses(cell, head_cell, q):
    """Walk the joint tree as the page does."""
    world = [pin.SE3.Identity()]
    for joint in head_cell["joints"]:
        rest = pin.XYZQUATToSE3(np.array(joint["p"] + joint["r"]))
        value = sum(factor * q[column] for column, factor in joint["map"]) + joint["offset"]
        axis = np.array(joint["axis"])
        if joint["turns"]:
            motion = pin.SE3(pin.exp3(axis * value), np.zeros(3))
        else:
            motion = pin.SE3(np.eye(3), axis * value)
        world.append(world[joint["joint"]] * rest * motion)
    frames = [*head_cell["frames"], head_cell["e1"], head_cell["e2"]]
    return {
        f["name"]: world[f["joint"]] * pin.XYZQUATToSE3(np.array(f["p"] + f["r"])) for f in frames
    }


def test_joint_tree_of_the_page_is_pinocchios():
    cell = task().cell
    head, array = unpack(scene().pack())
    data = cell.model.createData()
    for k, run in enumerate(answers().values()):
        q = array(head["runs"][k]["q"])
        np.testing.assert_allclose(q, run.q, atol=1e-6)
        pin.framesForwardKinematics(cell.model, data, cell.model_q(run.q[7]))
        found = poses(cell, head["cells"][0], q[7])
        assert len(found) > 14
        for name, pose in found.items():
            frame = {"e1": cell.e1, "e2": cell.e2}.get(name)
            frame = cell.model.getFrameId(name, pin.FrameType.BODY) if frame is None else frame
            np.testing.assert_allclose(pose.homogeneous, data.oMf[frame].homogeneous, atol=1e-5)


def test_meshes_are_stored_once_for_both_arms():
    cell = task().cell
    head, _ = unpack(scene().pack())
    bodies = head["cells"][0]["bodies"]
    assert len(bodies) == len(cell.visual.geometryObjects) + len(cell.collision.geometryObjects)
    assert len(head["meshes"]) == len(bodies) / 2
    assert len(head["cells"]) == len(head["paths"]) == 1


def test_cells_and_paths_are_told_apart():
    scene, path = Scene(), corner()
    scene.add_motion("one", pair(), path, *motions()[0])
    scene.add_motion("two", pair(), path.with_direction([0, 0, 1]), *motions()[1])
    assert [run["path"] for run in scene.head["runs"]] == [0, 1]
    assert [run["cell"] for run in scene.head["runs"]] == [0, 0]


@pytest.mark.parametrize(
    ("body", "volume"),
    [
        (coal.Box(0.2, 0.3, 0.4), 0.024),
        (coal.Sphere(0.5), 4 / 3 * np.pi * 0.5**3),
        (coal.Cylinder(0.1, 0.6), np.pi * 0.01 * 0.6),
        (coal.Capsule(0.1, 0.6), np.pi * 0.01 * 0.6 + 4 / 3 * np.pi * 0.001),
    ],
)
def test_primitives_are_closed_and_face_outward(body, volume):
    shape = triangles_of(body)
    x = shape.origin + shape.step * shape.corners
    a, b, c = (x[shape.faces[:, k]] for k in range(3))
    assert np.einsum("ij,ij", a, np.cross(b, c)) / 6 == pytest.approx(volume, rel=0.03)


def test_hulls_and_meshes_keep_their_place():
    for geometry in (pair().visual, pair().collision):
        item = geometry.geometryObjects[3]
        item.geometry.computeLocalAABB()
        shape, box = triangles_of(item.geometry), item.geometry.aabb_local
        x = shape.origin + shape.step * shape.corners
        np.testing.assert_allclose(x.min(axis=0), box.min_, atol=1e-4)
        np.testing.assert_allclose(x.max(axis=0), box.max_, atol=1e-4)


def test_heavy_meshes_get_coarser_but_keep_their_size():
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.3)
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(ball.faces), len(ball.vertices))
    mesh.addVertices(np.asarray(ball.vertices))
    for face in ball.faces:
        mesh.addTriangle(*(ball.vertices[i] for i in face))
    mesh.endModel()
    shape = triangles_of(mesh)
    assert len(shape.faces) <= 6_000 < len(ball.faces)
    x = shape.origin + shape.step * shape.corners
    np.testing.assert_allclose(np.linalg.norm(x, axis=1), 0.3, atol=0.005)


def test_names_are_escaped_and_nothing_is_fetched(tmp_path):
    bad = '</script><img src="http://evil.example/x">'
    file = tmp_path / "deep" / "animation.html"
    write_player(file, task(), {bad: answer()}, title=bad)
    text = file.read_text("utf-8")
    assert bad not in text
    assert "<title>&lt;/script&gt;&lt;img" in text
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", text)
    assert "default-src 'none'" in text
    data = re.search(r'<script id="data" type="text/plain">([^<]*)</script>', text).group(1)
    head, _ = unpack(gzip.decompress(base64.b64decode(data)))
    assert head["runs"][0]["label"] == bad


def test_page_is_small_and_the_same_every_time():
    first = player_page(task(), answers(), title="a")
    assert first == player_page(task(), answers(), title="a")
    assert len(first) < 1_000_000


def test_a_cell_alone_is_drawn_in_one_posture(tmp_path):
    cell = pair()
    text = posture_page("middle", cell, (cell.lower + cell.upper) / 2).decode("utf-8")
    data = re.search(r'<script id="data" type="text/plain">([^<]*)</script>', text).group(1)
    head, array = unpack(gzip.decompress(base64.b64decode(data)))
    q = array(head["runs"][0]["q"])
    np.testing.assert_allclose(q[0], (cell.lower + cell.upper) / 2, atol=1e-6)
    assert np.ptp(q, axis=0).max() == 0.0


def test_what_does_not_fit_is_refused():
    q, c = motions()[0]
    scene = Scene()
    with pytest.raises(ShapeError, match=r"q: run 'a': \(31, 12\) is expected; given \(30, 12\)"):
        scene.add_motion("a", pair(), corner(), q[:30], c)
    with pytest.raises(ShapeError, match=r"index: run 'a': \(31,\) is expected; given \(30,\)"):
        scene.add_motion("a", pair(), corner(), q, c[:30])
    with pytest.raises(InputError, match="there is no answer to show"):
        player_page(task(), {}, title="none")

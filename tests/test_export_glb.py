"""GLB files: the nodes stand where Pinocchio puts them, and look as on the page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from answers import answers, task
from commands import Run
from motion_cases import line_result, result_with_motion
from test_exports import SIX, pair

import dualarm_pin as dp
from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.errors import InputError, MissingExtraError, UnknownNameError
from dualarm_pin.motion import Motion
from dualarm_pin.relative import Relative

trimesh = pytest.importorskip("trimesh")

from dualarm_pin.exports.glb import animation, make, write
from dualarm_pin.exports.glb.read import ReadGlb
from dualarm_pin.show.scene import Scene

GLB = ["--to", "glb"]


@pytest.fixture(scope="module")
def paper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("paper") / "result"
    result_with_motion(folder, task(), answers()["result 0"])
    return folder


@pytest.fixture(scope="module")
def exported(paper: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return dp.export(paper, "glb", tmp_path_factory.mktemp("glb"), name="corner <b>")


def tree_of(exported: Any) -> tuple[dict[str, Any], bytes]:
    [data] = exported.texts.values()
    length = int.from_bytes(data[12:16], "little")
    return json.loads(data[20 : 20 + length]), data


def test_the_tips_follow_the_relative_path(exported: Any, paper: Path) -> None:
    """By the tree of the file alone; the poses are those of `Relative`, which knows no nodes."""
    assert exported.passed
    assert exported.files == ("da_corner_b.glb",)
    loaded, _ = load_result(paper)
    motion = Motion.load(paper)
    read = ReadGlb.of(tree_of(exported)[1])
    assert read.time == pytest.approx(motion.time, abs=1e-6)
    for k in (0, 77, 200, 311, 400):
        read.pose(float(motion.time[k]))
        pose = np.linalg.inv(read.node("e1")) @ read.node("e2")
        expected = Relative(loaded.cell, motion.q[k]).T_e1_e2.homogeneous
        assert pose == pytest.approx(expected, abs=2e-6)


def test_bodies_are_named_and_coloured_as_on_the_page(exported: Any, paper: Path) -> None:
    loaded, _ = load_result(paper)
    tree, _ = tree_of(exported)
    nodes = {node["name"]: node for node in tree["nodes"]}
    page = [b for b in Scene().cell_of(loaded.cell)["bodies"] if b["kind"] == "visual"]
    assert {body["name"] for body in page} == {n for n, node in nodes.items() if "mesh" in node}
    assert exported.bodies == len(page)
    for body in page:
        mesh = tree["meshes"][nodes[body["name"]]["mesh"]]
        material = tree["materials"][mesh["primitives"][0]["material"]]
        colour = material["pbrMetallicRoughness"]["baseColorFactor"]
        assert colour == pytest.approx(write.linear_colour(body["colour"]))
    assert len({str(body["colour"]) for body in page}) == len(tree["materials"]) > 1
    assert write.linear_colour([0.0, 0.5, 1.0, 0.3]) == pytest.approx(
        [0, 0.21404, 1, 0.3], abs=1e-5
    )


def test_the_file_is_gltf(exported: Any) -> None:
    pytest.importorskip("jsonschema")
    tree, data = tree_of(exported)
    trimesh.exchange.gltf.validate(tree)
    assert data[:4] == b"glTF"
    assert int.from_bytes(data[8:12], "little") == len(data)
    [motion] = tree["animations"]
    loaded = len({channel["target"]["node"] for channel in motion["channels"]})
    assert loaded == 12
    for channel in motion["channels"]:  # glTF forbids a matrix where something moves
        assert "matrix" not in tree["nodes"][channel["target"]["node"]]
    up = np.array(tree["nodes"][0]["matrix"]).reshape(4, 4).T
    assert up @ [0, 0, 1, 1] == pytest.approx([0, 1, 0, 1])


@pytest.mark.parametrize("kind", ["prismatic", "revolute"])
def test_joints_of_every_kind_move(kind: str, tmp_path: Path) -> None:
    cell = pair(tmp_path, SIX, prismatic=["j2"] if kind == "prismatic" else [])
    exported = dp.export(line_result(tmp_path, cell), "glb", tmp_path / "out")
    assert exported.passed
    tree, _ = tree_of(exported)
    paths = [channel["target"]["path"] for channel in tree["animations"][0]["channels"]]
    assert paths.count("translation") == (2 if kind == "prismatic" else 0)


def test_a_writer_that_is_wrong_writes_nothing(
    paper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def mirrored(quaternions: np.ndarray) -> np.ndarray:
        return quaternions * [1, 1, 1, -1]

    monkeypatch.setattr(animation, "_continuous", mirrored)
    assert not dp.export(paper, "glb", tmp_path / "out").passed
    monkeypatch.undo()
    placed = make.Nodes.of

    def shifted(cell: Any) -> Any:
        nodes = placed(cell)
        nodes.bodies[3].placement.translation += 0.001
        return nodes

    data = write.glb_bytes(shifted(task().cell), answers()["result 0"].q[:1], None)
    error = make._error(placed(task().cell), data, lambda _: answers()["result 0"].q[0])
    assert error.mm == pytest.approx(1e3 * np.sqrt(3e-6))
    assert not (tmp_path / "out").exists()


def test_a_posture_needs_no_motion(tmp_path: Path) -> None:
    result, answer = tmp_path / "result", answers()["result 0"]
    save_result(result, task(), answer)
    with pytest.raises(InputError, match=r"has no motion: make one with .* or give the point"):
        dp.export(result, "glb", tmp_path / "out")
    exported = dp.export(result, "glb", tmp_path / "out", point=13)
    assert exported.error.mm < 1e-6
    tree, data = tree_of(exported)
    assert "animations" not in tree
    read = ReadGlb.of(data)
    cell = task().cell
    pin.framesForwardKinematics(cell.model, cell.data(), cell.model_q(answer.q[12]))
    tip = cell.data().oMf[cell.e1].homogeneous
    assert read.node("e1") == pytest.approx(tip, abs=1e-12)
    report = json.loads((tmp_path / "out" / "export.json").read_text())
    assert (report["point"], report["format"]) == (13, "glb")
    for point in (0, 32):
        with pytest.raises(InputError, match="a point from 1 to 31 is expected"):
            dp.export(result, "glb", tmp_path / "out", point=point)


def test_what_is_no_solution_is_said(tmp_path: Path) -> None:
    loaded = task()
    middle = np.tile((loaded.cell.lower + loaded.cell.upper) / 2, (loaded.path.h, 1))
    save_result(tmp_path / "r", loaded, dp.verified(loaded, middle, method="mine", solver="none"))
    exported = dp.export(tmp_path / "r", "glb", tmp_path / "out", point=1)
    assert "CAUTION: this is no solution" in exported.as_text()


def test_the_command_says_what_it_wrote(paper: Path, tmp_path: Path, run: Run) -> None:
    done = run("export", paper, *GLB, "--out", "out", "--name", "corner", cwd=tmp_path)
    assert done.returncode == 0
    assert "40 bodies, 401 keys of 4.000 s" in done.stdout
    assert "from where Pinocchio puts it, allowed are 0.5 mm and 0.05 deg" in done.stdout
    assert "written: out/da_corner.glb" in done.stdout
    done = run("export", paper, *GLB, "--out", "b", "--mm", "1e-9", cwd=tmp_path)
    assert done.returncode == 1
    assert not (tmp_path / "b").exists()
    done = run("export", paper, "--to", "ros2", "--out", "b", "--point", "3", cwd=tmp_path)
    assert done.returncode == 2
    assert "a posture goes to glb alone" in done.stderr


def test_without_trimesh_the_extra_is_named(
    paper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"pip install 'dualarm-pin\[glb\]'"):
        dp.export(paper, "glb", tmp_path)


def test_a_name_that_is_nearly_it_is_said(paper: Path, tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'glb'"):
        dp.export(paper, "gbl", tmp_path)

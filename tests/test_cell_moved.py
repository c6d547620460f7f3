"""A moved cell is the cell that would be loaded with those bases, and reads no file."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from robot_table import SINGLE, arguments, needs_robots
from test_bad_robots import SOUND
from test_cell_files import PAIR, TORSO

from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.relative import Relative

NS16 = urdf_folder() / "ns16" / "ns16.urdf"
BASE1 = pin.SE3(pin.rpy.rpyToMatrix(-0.3, 0.2, 1.0), np.array([0.4, -0.2, 0.6]))
BASE2 = pin.SE3(pin.rpy.rpyToMatrix(0.1, -0.2, 3.0), np.array([1.9, 0.3, 0.1]))
TOOL = pin.SE3(pin.rpy.rpyToMatrix(0.5, 0.1, 0.2), np.array([0.0, 0.02, 0.1]))


def same_pose(first: pin.SE3, second: pin.SE3) -> None:
    np.testing.assert_allclose(first.homogeneous, second.homogeneous, rtol=0, atol=1e-12)


def same_model(first: pin.Model, second: pin.Model) -> None:
    assert list(first.names) == list(second.names)
    assert list(first.parents) == list(second.parents)
    for a, b in zip(first.jointPlacements, second.jointPlacements, strict=True):
        same_pose(a, b)
    for a, b in zip(first.frames, second.frames, strict=True):
        assert (a.name, a.type, a.parentJoint) == (b.name, b.type, b.parentJoint)
        same_pose(a.placement, b.placement)
    for a, b in zip(first.inertias, second.inertias, strict=True):
        np.testing.assert_allclose(a.matrix(), b.matrix(), rtol=1e-12, atol=1e-12)
    for limit in ("lowerPositionLimit", "upperPositionLimit", "velocityLimit", "effortLimit"):
        np.testing.assert_array_equal(getattr(first, limit), getattr(second, limit))


def same_bodies(first: pin.GeometryModel, second: pin.GeometryModel) -> None:
    for a, b in zip(first.geometryObjects, second.geometryObjects, strict=True):
        assert (a.name, a.parentJoint, a.parentFrame) == (b.name, b.parentJoint, b.parentFrame)
        same_pose(a.placement, b.placement)
    pairs = [[(p.first, p.second) for p in model.collisionPairs] for model in (first, second)]
    assert pairs[0] == pairs[1]


def same_answers(moved: Cell, loaded: Cell, tolerance: float = 1e-12) -> None:
    """Compare model, bodies, tips, Jacobians and clearances."""
    same_model(moved.model, loaded.model)
    same_bodies(moved.collision, loaded.collision)
    for q in np.random.default_rng(0).uniform(loaded.lower, loaded.upper, (5, loaded.n)):
        at, there = Relative(moved, q), Relative(loaded, q)
        same_pose(at.T_e1_e2, there.T_e1_e2)
        np.testing.assert_allclose(at.J_r, there.J_r, rtol=0, atol=1e-12)
        for between in (False, True):
            one, other = (c.clearance(q, between_arms=between) for c in (moved, loaded))
            assert (one is None) == (other is None)
            if one is not None:
                assert one.distance == pytest.approx(other.distance, abs=tolerance)


def same_cell(moved: Cell, loaded: Cell) -> None:
    """Compare everything that a cell says of itself."""
    same_answers(moved, loaded)
    same_bodies(moved.visual, loaded.visual)
    for a, b in zip(moved.arms, loaded.arms, strict=True):
        assert (a.name, a.file, a.root, a.tip, a.joints) == (
            b.name,
            b.file,
            b.root,
            b.tip,
            b.joints,
        )
        same_pose(a.base, b.base)
        same_pose(a.tool, b.tool)
    for name in ("name", "e1", "e2", "joints", "locked", "warnings", "sources", "dropped_pairs"):
        assert getattr(moved, name) == getattr(loaded, name), name
    np.testing.assert_array_equal(moved.joint_map, loaded.joint_map)
    np.testing.assert_array_equal(moved.joint_offset, loaded.joint_offset)
    q = (loaded.lower + loaded.upper) / 2
    one, other = moved.clearance(q, exact=True), loaded.clearance(q, exact=True)
    assert one.distance == pytest.approx(other.distance, abs=1e-12)
    said, expected = describe(moved).as_dict(), describe(loaded).as_dict()
    assert said.pop("smallest_singular_value") == pytest.approx(
        expected.pop("smallest_singular_value"), abs=1e-12
    )
    assert said == expected


@pytest.mark.parametrize("start", ["at the origin", "elsewhere"])
def test_a_moved_cell_is_the_cell_loaded_there(start: str) -> None:
    tools = (TOOL, None)
    bases = {} if start == "at the origin" else {"base1": TOOL, "base2": BASE1}
    cell = Cell.from_urdf(NS16, NS16, tools=tools, **bases)
    loaded = Cell.from_urdf(NS16, NS16, tools=tools, base1=BASE1, base2=BASE2)
    same_cell(cell.moved(base1=BASE1, base2=BASE2), loaded)
    same_cell(cell.moved(base1=BASE1).moved(base2=BASE2), loaded)
    one = Cell.from_urdf(NS16, NS16, tools=tools, **(bases | {"base2": BASE2}))
    same_cell(cell.moved(base2=BASE2), one)


@needs_robots
@pytest.mark.parametrize("name", [row[0] for row in SINGLE])
def test_every_robot_of_the_table_moves(name: str) -> None:
    urdfs, options, _ = arguments(name)
    cell = Cell.from_urdf(*urdfs, **options)
    loaded = Cell.from_urdf(*urdfs, base2=BASE2, **options)
    # Places agree to 1e-12, but Coal stops its search for the distance of curved hulls at 1e-6.
    same_answers(cell.moved(base2=BASE2), loaded, tolerance=1e-6)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "small.urdf").write_text(SOUND)
    (tmp_path / "twin.urdf").write_text(TORSO)
    return tmp_path


def load(folder: Path, text: str) -> Cell:
    file = folder / "cell.yaml"
    file.write_text(text)
    return Cell.load(file)


def test_a_frame_without_a_robot_moves_too(folder: Path) -> None:
    text = "arms:\n  arm1: {base: {xyz: [1, 2, 3]}, tool: {xyz: [0, 0, 1]}}\n  arm2: ARM}\n"
    text = text.replace("ARM", "{urdf: small.urdf, tip: tip")
    cell = load(folder, text)
    moved = cell.moved(base1=BASE1, base2=BASE2)
    assert moved.arms[0].base.isApprox(BASE1, 1e-12)
    pin.framesForwardKinematics(moved.model, moved.data(), np.zeros(3))
    tool = BASE1 * pin.SE3(np.eye(3), np.array([0.0, 0.0, 1.0]))
    same_pose(moved.data().oMf[moved.e1], tool)


def test_an_arm_whose_tip_is_its_root_moves(folder: Path) -> None:
    file = folder / "small.urdf"
    options = {"tips": ("base", "tip"), "tools": (TOOL, None)}
    cell = Cell.from_urdf(file, file, **options)
    loaded = Cell.from_urdf(file, file, base1=BASE1, base2=BASE2, **options)
    same_cell(cell.moved(base1=BASE1, base2=BASE2), loaded)


OPENED: list[str] = []
WATCHED = [False]


def note_opened(event: str, args: tuple) -> None:
    if WATCHED[0] and event == "open":
        OPENED.append(str(args[0]))


sys.addaudithook(note_opened)  # there is no way to take it back, so it has a switch


def test_no_file_is_opened_and_shapes_are_shared(monkeypatch: pytest.MonkeyPatch) -> None:
    cell = Cell.from_urdf(NS16, NS16, base2=BASE2)
    q = (cell.lower + cell.upper) / 2
    cell.clearance(q, exact=True)
    assert cell.visual.ngeoms
    monkeypatch.setattr("dualarm_pin.cell.build_bodies.load_mesh", None)
    OPENED.clear()
    WATCHED[0] = True
    try:
        moved = cell.moved(base1=BASE1)
        moved.clearance(q)
        moved.clearance(q, exact=True)
        assert moved.visual.ngeoms
        Relative(moved, q)
    finally:
        WATCHED[0] = False
    assert OPENED == []
    for kind in ("collision", "visual"):
        pairs = zip(*(getattr(c, kind).geometryObjects for c in (cell, moved)), strict=True)
        assert all(a.geometry == b.geometry for a, b in pairs)


def test_bodies_are_loaded_once_for_all_moved_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    from dualarm_pin.cell import bodies

    calls: list[str] = []
    build = bodies.build_bodies
    monkeypatch.setattr(
        bodies, "build_bodies", lambda *a, **k: calls.append(a[2]) or build(*a, **k)
    )
    cell = Cell.from_urdf(NS16, NS16, base2=BASE2)
    for x in (1.0, 2.0, 3.0):
        moved = cell.moved(base2=pin.SE3(np.eye(3), np.array([x, 0.0, 0.0])))
        moved.clearance(moved.lower)
    assert calls == ["collision"]


def test_moving_leaves_the_cell_as_it_was(folder: Path) -> None:
    cell = load(folder, PAIR)
    before = Relative(cell, np.zeros(6)).T_e1_e2.copy()
    clearance = cell.clearance(np.zeros(6))
    base = pin.SE3(BASE2)
    moved = cell.moved(base2=base)
    base.translation = np.zeros(3)
    same_pose(moved.arms[1].base, BASE2)
    same_pose(Relative(cell, np.zeros(6)).T_e1_e2, before)
    assert cell.clearance(np.zeros(6)) == clearance
    same_pose(moved.moved(base2=cell.arms[1].base).arms[1].base, cell.arms[1].base)


def test_many_moves_do_not_drift() -> None:
    cell = moved = Cell.from_urdf(NS16, NS16)
    for k in range(300):
        moved = moved.moved(base1=pin.SE3.Random(), base2=pin.SE3.Random() if k % 2 else None)
    moved = moved.moved(base1=BASE1, base2=BASE2)
    same_model(moved.model, cell.moved(base1=BASE1, base2=BASE2).model)


def test_a_moved_cell_can_be_pickled() -> None:
    moved = Cell.from_urdf(NS16, NS16).moved(base2=BASE2)
    q = (moved.lower + moved.upper) / 2
    again = pickle.loads(pickle.dumps(moved))
    same_model(again.model, moved.model)
    assert again.clearance(q) == moved.clearance(q)


def test_bases_that_cannot_be(folder: Path) -> None:
    both = Cell.from_urdf(folder / "twin.urdf", tips=("l3", "r3"))
    with pytest.raises(InputError, match=r"base1: one URDF holds both arms of twin.*own"):
        both.moved(base1=BASE1)
    assert both.moved().arms[0].base == both.arms[0].base
    cell = load(folder, PAIR)
    with pytest.raises(ShapeError, match=r"base2: a pose \(pinocchio.SE3\) is expected.*ndarray"):
        cell.moved(base2=np.eye(4))
    far = pin.SE3(np.eye(3), np.array([np.nan, 0.0, 0.0]))
    with pytest.raises(InputError, match=r"base1: .*not finite"):
        cell.moved(base1=far)
    with pytest.raises(InputError, match=r"base1: .*not a rotation"):
        cell.moved(base1=pin.SE3(2 * np.eye(3), np.zeros(3)))

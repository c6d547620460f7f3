"""The player in a real browser: offline, drawn, and where Pinocchio says the links are."""

import numpy as np
import pinocchio as pin
import pytest
from answers import answer, answers, task
from browser import chromium, opened
from ns16_pair import motions, pair
from patience import wait_until

from dualarm_pin.answer.verify import verified
from dualarm_pin.cell import Cell
from dualarm_pin.path import Path
from dualarm_pin.relative import Relative
from dualarm_pin.show import Player, player_page, serving, write_player
from dualarm_pin.task import Task

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "animation.html"
    shown = {f"run {k} <b>": t for k, t in enumerate(answers().values())}
    write_player(file, task(), shown, title='Three & "runs" <i>')
    return file


@pytest.fixture(scope="module")
def view(file):
    with opened(file.as_uri()) as view:
        yield view


def between(q, t):
    at = t * (len(q) - 1)
    k = min(int(at), len(q) - 2)
    return q[k] + (at - k) * (q[k + 1] - q[k])


def test_page_needs_nothing_but_itself(view, file):
    assert view.requests[0] == file.as_uri()
    assert {url.split(":")[0] for url in view.requests[1:]} <= {"data", "blob"}
    assert view.complaints == []
    assert view.do("document.title") == 'Three & "runs" <i>'
    assert view.do("dualarm.runs") == ["run 0 <b>", "run 1 <b>", "run 2 <b>"]


@pytest.mark.parametrize("run", [0, 1, 2])
@pytest.mark.parametrize("t", [0.0, 0.2, 0.31, 0.5, 0.516, 0.777, 1.0])
def test_links_are_where_pinocchio_puts_them(view, run, t):
    """At the path points (0, 0.2, 0.5, 1) and between them: there q is linear."""
    cell, data = pair(), pair().model.createData()
    pin.framesForwardKinematics(cell.model, data, cell.model_q(between(motions()[run][0], t)))
    view.do(f"dualarm.select({run}); dualarm.seek({t})")
    found = view.do("Object.fromEntries(dualarm.links.map((n) => [n, dualarm.linkPose(n)]))")
    assert {"arm1/flange", "arm2/link_3", "e1", "e2"} <= set(found)
    for name, pose in found.items():
        frame = {"e1": cell.e1, "e2": cell.e2}.get(name)
        frame = cell.model.getFrameId(name, pin.FrameType.BODY) if frame is None else frame
        expected = data.oMf[frame]
        np.testing.assert_allclose(pose["position"], expected.translation, atol=1e-4)
        turned = pin.Quaternion(np.array(pose["quaternion"], dtype=float)).matrix()
        np.testing.assert_allclose(turned, expected.rotation, atol=1e-4)


@pytest.mark.parametrize("layout", ["one", "overlay", "side"])
def test_links_stay_right_in_every_layout_and_with_e1_held(view, layout):
    cell, data = pair(), pair().model.createData()
    view.do(f"dualarm.select(0); dualarm.layout('{layout}'); dualarm.show('hold', true)")
    view.do("dualarm.seek(0.6)")
    pin.framesForwardKinematics(cell.model, data, cell.model_q(between(motions()[0][0], 0.6)))
    tip = view.do("dualarm.linkPose('arm2/flange').position")
    view.do("dualarm.layout('one'); dualarm.show('hold', false)")
    expected = data.oMf[cell.model.getFrameId("arm2/flange")].translation
    np.testing.assert_allclose(tip, expected, atol=1e-4)
    assert view.complaints == []


def test_both_robots_are_drawn_and_move(view):
    view.do("dualarm.select(2); dualarm.layout('one'); dualarm.look('front'); dualarm.seek(0)")
    first = view.picture()
    red = (first[..., 0] > 90) & (first[..., 0] > 2 * first[..., 1])
    columns = np.flatnonzero(red.any(axis=0))
    middle = columns.mean()
    left, right = red[:, : int(middle)].sum(), red[:, int(middle) :].sum()
    assert min(left, right) > 0.01 * red.size
    view.do("dualarm.seek(1)")
    changed = np.abs(view.picture() - first).max(axis=2) > 30
    assert changed.sum() > 0.002 * red.size
    view.do("dualarm.show('visual', false)")
    empty = view.picture()
    view.do("dualarm.show('visual', true)")
    gone = (empty[..., 0] > 90) & (empty[..., 0] > 2 * empty[..., 1])
    assert gone.sum() < 0.1 * red.sum()


def test_every_switch_changes_the_picture(view):
    view.do("dualarm.select(1); dualarm.look('close'); dualarm.seek(0.4)")
    switches = ["collision", "path", "frames", "direction", "force", "velocity", "ghosts"]
    for name in switches:
        pictures = []
        for on in ("true", "false"):
            view.do(f"dualarm.show('{name}', {on})")
            pictures.append(view.picture())
        assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 12).sum() > 20, name
    for name in ("path", "frames", "direction"):
        view.do(f"dualarm.show('{name}', true)")
    view.do("dualarm.look('corner')")


def test_ellipsoid_agrees_with_the_relative_jacobian(view):
    q = between(motions()[2][0], 0.45)
    J = Relative(pair(), q).J_r[:3]
    view.do("dualarm.select(2); dualarm.seek(0.45)")
    A = view.do("dualarm.player.on_stage[0].robot.manipulability()")
    np.testing.assert_allclose(A, J @ J.T, atol=1e-5)
    eigen = view.do("DA.eigen(dualarm.player.on_stage[0].robot.manipulability())")
    values, V = np.array(eigen["values"]), np.array(eigen["vectors"])
    np.testing.assert_allclose(np.sort(values), np.linalg.eigvalsh(J @ J.T), atol=1e-5)
    np.testing.assert_allclose(V @ np.diag(values) @ V.T, J @ J.T, atol=1e-5)


def test_scrubber_buttons_and_keys(view):
    page = view.page
    view.do("dualarm.select(0); dualarm.seek(0.25)")
    assert float(page.locator(".scrub").input_value()) == pytest.approx(0.25)
    page.locator(".scrub").evaluate(
        "(e) => { e.value = 0.75; e.dispatchEvent(new Event('input')) }"
    )
    assert view.do("dualarm.time()") == pytest.approx(0.75)
    page.locator(".scrub").evaluate("(e) => e.blur()")
    page.keyboard.press("ArrowLeft")
    assert view.do("dualarm.time()") == pytest.approx(0.75 - 1 / 30)
    view.do("dualarm.speed(4); dualarm.seek(0)")
    page.locator(".play").click()
    assert page.locator(".play").get_attribute("aria-label") == "Pause"
    wait_until(lambda: view.do("dualarm.time()") > 0, "playing")
    view.do("dualarm.pause()")
    assert view.do("dualarm.time()") > 0
    strip = page.locator(".strip").bounding_box()
    page.mouse.click(strip["x"] + 0.5 * strip["width"], strip["y"] + 20)
    assert view.do("dualarm.time()") == pytest.approx(0.5, abs=0.01)
    page.locator("[data-run='2'] [type=radio]").click()
    assert page.locator(".readout b").inner_text() == "run 2 <b>"
    assert view.complaints == []


def test_unknown_names_are_said(view):
    with pytest.raises(Exception, match="no link nose; known: cell, arm1/base_link"):
        view.do("dualarm.linkPose('nose')")
    with pytest.raises(Exception, match="no run 9; there are 3"):
        view.do("dualarm.select(9)")
    with pytest.raises(Exception, match="no switch hats; known: visual, collision"):
        view.do("dualarm.show('hats', true)")


def test_the_local_address_shows_the_same_page():
    page = player_page(task(), {"one": answer()}, title="live")
    with serving(page) as address, opened(address) as view:
        assert view.do("dualarm.runs") == ["one"]
        assert {url.split(":")[0] for url in view.requests[1:]} <= {"data", "blob"}
        assert view.complaints == []


SLIDER = """<robot name="slider">
  <link name="root"><visual><geometry><box size="0.3 0.2 0.1"/></geometry></visual></link>
  <link name="car"><visual><geometry>
    <cylinder radius="0.1" length="0.3"/></geometry></visual></link>
  <link name="tip"><visual><geometry><sphere radius="0.05"/></geometry></visual></link>
  <joint name="slide" type="prismatic"><parent link="root"/><child link="car"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/><axis xyz="0.6 0 0.8"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <joint name="turn" type="continuous"><parent link="car"/><child link="tip"/>
    <origin xyz="0.2 0 0.1" rpy="0.1 0.2 -0.3"/><axis xyz="0 -1 0"/></joint>
</robot>"""


def test_prismatic_and_continuous_joints_move_as_pinocchio_says(tmp_path):
    urdf, file = tmp_path / "slider.urdf", tmp_path / "page.html"
    urdf.write_text(SLIDER)
    base2 = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 2.0), np.array([1.0, 0.3, 0.2]))
    cell = Cell.from_urdf(urdf, urdf, base2=base2, tips=("tip", "tip"))
    path = Path([[0, 0, 0], [0.1, 0, 0], [0.2, 0.1, 0]], np.eye(3))
    q = np.random.default_rng(3).uniform(-1, 1, (3, 4))
    shown = Task(cell, path)
    slide = verified(shown, q, method="drawn", solver="none")
    write_player(file, shown, {"slide": slide}, title="sliders")
    data = cell.model.createData()
    with opened(file.as_uri()) as view:
        for t in (0.0, 0.3, 0.5, 0.9):
            pin.framesForwardKinematics(cell.model, data, cell.model_q(between(q, t)))
            view.do(f"dualarm.seek({t})")
            for name, frame in (("e1", cell.e1), ("e2", cell.e2)):
                found = view.do(f"dualarm.linkPose('{name}').position")
                np.testing.assert_allclose(found, data.oMf[frame].translation, atol=1e-5)
            J = Relative(cell, between(q, t)).J_r[:3]
            A = view.do("dualarm.player.on_stage[0].robot.manipulability()")
            np.testing.assert_allclose(A, J @ J.T, atol=1e-5)
        assert view.complaints == []


def test_a_saved_notebook_cell_shows_the_robots(tmp_path):
    shown = Player(task(), {"one": answer()}, height=420, at=0.5)
    file = tmp_path / "saved.html"
    file.write_text(f"<!doctype html><body>{shown._repr_html_()}</body>", encoding="utf-8")
    page = chromium().new_page()
    try:
        asked, said = [], []
        page.on("request", lambda r: asked.append(r.url))
        page.on("pageerror", lambda e: said.append(str(e)))
        page.goto(file.as_uri())
        inner = page.frames[1]
        assert inner.evaluate("dualarm.ready.then(() => dualarm.runs)") == ["one"]
        assert inner.evaluate("dualarm.time()") == 0.5
        assert all(url.split(":")[0] in ("file", "data", "blob", "about") for url in asked)
        assert said == []
    finally:
        page.close()


def test_dark_phone_has_the_panel_closed(file):
    with opened(file.as_uri(), 390, 780, color_scheme="dark") as view:
        assert view.do("document.querySelector('.panel').open") is False
        assert view.do("document.documentElement.scrollWidth <= innerWidth")
        ground = view.do("getComputedStyle(document.body).backgroundColor")
        assert max(int(v) for v in ground[4:-1].split(",")[:3]) < 60
        assert view.complaints == []

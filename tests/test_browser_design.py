"""The design page in a real browser: what is dragged, touched or typed, the motion follows."""

from urllib.parse import urlsplit

import numpy as np
import pinocchio as pin
import pytest
from browser import opened
from drag import SPOT
from paper_case import task

from dualarm_pin.design.server import Pages
from dualarm_pin.relative import Relative
from dualarm_pin.show import serving
from dualarm_pin.task.changed import changed_task
from dualarm_pin.task.moved import moved_task

pytestmark = pytest.mark.browser

CHANGE = {"base2.x": -0.12, "base2.y": 0.05, "base2.z": 0.04, "base2.yaw": 0.1} | {
    "workpiece.x": 0.02, "workpiece.yaw": 0.1, "tool2.length": 0.03,
}  # fmt: skip


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    with Pages(task(), tmp_path_factory.mktemp("saved")) as pages:
        yield pages


@pytest.fixture(scope="module")
def address(pages):
    with serving(pages.open, 0, pages.talk) as address:
        yield address


@pytest.fixture(scope="module")
def page(address):
    with opened(address, has_touch=True) as view:
        view.do("dualarm.design.idle()")
        yield view


@pytest.fixture
def view(page):
    yield page
    page.do("(async () => { const d = dualarm.design; while (d.history.length) d.undo();"
            " d.choose('base2'); await d.idle(); })()")  # fmt: skip
    assert page.complaints == []


def state(view):
    return view.do("dualarm.design.state")


def shown(view, name):
    return view.do(f"dualarm.design.shown.{name}")


def until(view, said):
    """Wait in the page: its policy forbids what Playwright waits with."""
    view.do(
        f"(async () => {{ const d = dualarm.design; while (!({said}))"
        " await new Promise((done) => setTimeout(done, 20)); })()"
    )


def dragged(view, part, by, steps=8):
    x, y = view.page.evaluate(SPOT, part)
    mouse = view.page.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + by[0], y + by[1], steps=steps)
    mouse.up()
    view.do("dualarm.design.idle()")


def test_links_and_path_are_where_pinocchio_puts_them_after_everything_moved(view):
    there = moved_task(task(), CHANGE)
    view.page.evaluate("(c) => { dualarm.design.set(c); dualarm.design.commit(); }", CHANGE)
    view.do("dualarm.design.idle()")
    assert shown(view, "found.found")
    q = np.array(view.do("Array.from(dualarm.design.view.q)")).reshape(there.path.h, -1)
    data = there.cell.model.createData()
    for point in (0, 13, 30):
        view.do(f"dualarm.seek({point / 30})")
        pin.framesForwardKinematics(there.cell.model, data, there.cell.model_q(q[point]))
        for name in ("arm1/flange", "arm2/base_link", "arm2/link_1", "arm2/link_6", "e1", "e2"):
            frame = {"e1": there.cell.e1, "e2": there.cell.e2}.get(name)
            if frame is None:
                frame = there.cell.model.getFrameId(name, pin.FrameType.BODY)
            pose = view.do(f"dualarm.linkPose({name!r})")
            x, y, z, w = pose["quaternion"]
            assert pose["position"] == pytest.approx(data.oMf[frame].translation, abs=1e-5)
            turn = pin.Quaternion(w, x, y, z).matrix()
            assert turn == pytest.approx(data.oMf[frame].rotation, abs=1e-5)
        tip = Relative(there.cell, q[point]).T_e1_e2.translation
        assert tip == pytest.approx(there.path.position[point], abs=1e-6)
        # The point of the drawn path, in e1: where the moved task has it.
        drawn = view.page.evaluate(
            "([p]) => new MeshCat.THREE.Vector3(...p).applyMatrix4(("
            "dualarm.design.view.marks.path[0].updateMatrix(),"
            " dualarm.design.view.marks.path[0].matrix)).toArray()",
            [task().path.position[point].tolist()],
        )
        assert drawn == pytest.approx(there.path.position[point], abs=1e-6)


@pytest.mark.parametrize("part", ["x", "y", "z", "yaw"])
def test_the_mouse_drags_one_coordinate_and_the_best_motion_follows(view, part):
    eye = view.do("dualarm.player.stage.viewer.camera.position.toArray()")
    dragged(view, part, {"x": (-40, -10), "y": (12, -20), "z": (0, -15), "yaw": (14, 9)}[part])
    change = {k: v for k, v in state(view)["change"].items() if v}
    assert list(change) == [f"base2.{part}"]
    assert 0.005 < abs(change[f"base2.{part}"]) < 1.0
    assert view.do("dualarm.player.stage.viewer.camera.position.toArray()") == eye
    q = np.array(view.do("Array.from(dualarm.design.view.q)")).reshape(31, 12)
    objective = moved_task(task(), change).problem().objective(q)
    assert objective == pytest.approx(shown(view, "objective"), rel=1e-5)
    assert shown(view, "found.found")
    assert "Found and checked" in view.page.inner_text("#desk .state")


def test_a_drag_beside_the_gizmo_turns_the_camera_and_moves_nothing(view):
    eye = view.do("dualarm.player.stage.viewer.camera.position.toArray()")
    view.page.mouse.move(80, 500)
    view.page.mouse.down()
    view.page.mouse.move(140, 500, steps=4)
    view.page.mouse.up()
    assert view.do("dualarm.player.stage.viewer.camera.position.toArray()") != eye
    assert not any(state(view)["change"].values())
    view.do("dualarm.look('corner')")


def test_a_finger_drags_too(view):
    x, y = view.page.evaluate(SPOT, "x")
    touch = view.page.context.new_cdp_session(view.page)
    touch.send(
        "Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]}
    )
    for step in range(1, 7):
        points = [{"x": x - 6 * step, "y": y - step}]
        touch.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": points})
    touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    view.do("dualarm.design.idle()")
    assert state(view)["change"]["base2.x"] < -0.01
    assert view.do("dualarm.design.history.length") == 1


def test_keys_shift_and_turn_and_undo(view):
    view.do("dualarm.player.canvas.focus()")
    press = view.page.keyboard.press
    for key in ("ArrowLeft", "ArrowLeft", "Shift+ArrowUp", "PageUp", "["):
        press(key)
    change = state(view)["change"]
    assert [change[f"base2.{a}"] for a in ("x", "y", "z")] == pytest.approx([-0.02, 0.001, 0.01])
    assert change["base2.yaw"] == pytest.approx(np.pi / 180)
    for _ in range(5):
        press("Control+z")
    view.do("dualarm.design.idle()")
    assert not any(state(view)["change"].values())
    assert shown(view, "objective") == pytest.approx(12.730887, abs=1e-4)
    press("Control+Shift+z")
    press("Control+y")
    view.do("dualarm.design.idle()")
    assert state(view)["change"]["base2.x"] == pytest.approx(-0.02)
    view.page.click("#desk button:text-is('Redo')")
    assert state(view)["change"]["base2.y"] == pytest.approx(0.001)
    view.do("dualarm.player.canvas.focus()")
    press("ArrowRight")  # another way on: what was undone is gone
    assert view.page.is_disabled("#desk button:text-is('Redo')")


def test_numbers_and_sliders_are_followed_and_undone(view):
    view.page.fill("[data-axis=x]", "2.4")
    view.page.press("[data-axis=x]", "Enter")
    slider = view.page.locator("input[aria-label='λ']")
    slider.focus()
    for _ in range(5):
        view.page.keyboard.press("ArrowRight")
    view.page.select_option("#desk select", label="arm1/joint_5")
    view.page.locator("input[aria-label='upper']").focus()
    view.page.keyboard.press("ArrowRight")
    view.do("dualarm.design.idle()")
    now = state(view)
    assert now["change"]["base2.x"] == pytest.approx(-0.1)
    assert now["smoothness"] > 3.0
    there = changed_task(
        moved_task(task(), now["change"]), smoothness=now["smoothness"], limits=now["limits"]
    )
    assert there.cell.upper[4] > task().cell.upper[4]
    q = np.array(view.do("Array.from(dualarm.design.view.q)")).reshape(31, 12)
    assert (q <= there.cell.upper + 1e-6).all()
    assert there.problem().objective(q) == pytest.approx(shown(view, "objective"), rel=1e-5)


def test_an_impossible_place_greys_the_motion_and_says_why_until_it_is_left(view):
    view.do("dualarm.design.set({'base2.x': 3.0}); dualarm.design.commit(); dualarm.design.idle()")
    assert "No motion here: point 1 of 31 has no solution" in view.page.inner_text("#desk .state")
    assert view.do("dualarm.player.stage.element.classList.contains('stale')")
    assert view.page.is_disabled("#desk button:text-is('Save')")
    view.page.click("#desk button:text-is('Undo')")
    view.do("dualarm.design.idle()")
    assert not view.do("dualarm.player.stage.element.classList.contains('stale')")


def test_while_a_motion_follows_its_clearance_is_measured_and_what_is_lost_stands_grey(view):
    view.do("dualarm.design.set({'base2.x': -0.1})")  # no commit: it is still held
    until(view, "d.shown.state.change['base2.x'] === -0.1 && !d.busy")
    cell = moved_task(task(), {"base2.x": -0.1}).cell
    q = np.array(view.do("Array.from(dualarm.design.view.q)")).reshape(31, 12)
    near, distances = shown(view, "near"), [cell.distances(q_i) for q_i in q]
    least = np.min(np.array(distances)[:, cell.apart_by_nature])
    assert least > 0.0
    assert near["distance"] == pytest.approx(least, abs=1e-6)
    # Words are written a few times a second.
    until(view, f"d.near.textContent.startsWith('{least:.3f} m at point')")
    view.do("dualarm.design.set({'base2.x': 4.0})")
    until(view, "!d.shown.valid")
    assert view.do("dualarm.player.stage.element.classList.contains('stale')")
    assert "No motion here" in view.page.inner_text("#desk .state")
    assert view.do("Array.from(dualarm.design.view.q)") == q.ravel().tolist()
    view.do("dualarm.design.set({'base2.x': -0.1})")
    until(view, "d.shown.valid")
    assert not view.do("dualarm.player.stage.element.classList.contains('stale')")
    view.do("dualarm.design.commit()")


def test_while_something_is_dragged_words_wait_and_the_picture_does_not(view):
    x, y = view.page.evaluate(SPOT, "x")
    view.page.mouse.move(x, y)
    view.page.mouse.down()
    view.do("""(() => { const d = dualarm.design, tell = d.tellNow.bind(d), show = d.show.bind(d);
      window.told = window.came = 0;
      d.tellNow = () => { window.told += 1; tell(); };
      d.show = (...given) => { window.came += 1; show(...given); }; })()""")
    begun = view.do("performance.now()")
    for k in range(30):
        view.page.mouse.move(x - 2 * k, y)
    until(view, "window.came >= 8")
    seconds = (view.do("performance.now()") - begun) / 1000
    assert view.do("window.told") <= 1 + 4 * seconds
    view.page.mouse.up()
    view.do("delete dualarm.design.tellNow; delete dualarm.design.show; dualarm.design.idle()")
    now = state(view)["change"]["base2.x"]
    assert view.do("dualarm.design.fields.x.valueAsNumber") == pytest.approx(2.5 + now, abs=1e-3)


def test_a_pose_that_is_too_old_when_it_would_be_drawn_is_left_out_while_newer_ones_come(view):
    # In one go: else the page draws in between.
    drawn = """(newer) => { const d = dualarm.design, w = d.drawing, before = d.player.frames || 0;
      d.moving = newer; w.has(performance.now() - 200); w.draw(); d.moving = false;
      return [d.player.frames - before, w.behind]; }"""
    assert view.page.evaluate(drawn, True) == [0, 1]
    # Nothing newer comes: then it is the best there is.
    assert view.page.evaluate(drawn, False) == [1, 0]


def test_what_would_be_seen_too_late_is_not_drawn(view):
    two = "dualarm.design.set({{'base2.x': {}}}); dualarm.design.set({{'base2.x': {}}})"
    view.do("(dualarm.design.drawing.late = 0, DA.oldest = 1e9)")
    view.do(two.format(0.01, 0.02))  # the second waits for the answer to the first
    until(view, "d.shown.state.change['base2.x'] === 0.02 && !d.busy")
    assert view.do("dualarm.design.drawing.late") == 0
    view.do("(DA.oldest = 0)")  # everything is too late now, but what nothing newer follows
    for k in range(20):  # a look at the search may be on its way: then nothing waits
        last = 0.04 + 0.01 * (k % 2)
        view.do(two.format(0.03, last))
        until(view, f"d.shown.state.change['base2.x'] === {last} && !d.busy")
        if view.do("dualarm.design.drawing.late"):
            break
    # One that was answered; another may have been answered before and not been drawn yet.
    assert view.do("dualarm.design.drawing.late") in (1, 2)
    until(view, "d.drawing.behind === 0 && d.drawing.fresh === null")  # the last one is drawn
    view.do("(DA.oldest = 150)")
    view.do("dualarm.design.commit(); dualarm.design.idle()")


def test_variants_are_kept_restored_and_saved(view, pages):
    view.do("dualarm.design.set({'base2.x': -0.2}); dualarm.design.commit(); dualarm.design.idle()")
    best = shown(view, "objective")
    view.page.fill("#desk input[type=text]", "near <b>")
    view.page.click("#desk button:text-is('Keep')")
    view.page.click("#desk button:text-is('Undo')")
    view.do("dualarm.design.idle()")
    assert shown(view, "objective") > best
    assert view.page.inner_text(".variants .name") == "near <b>"
    view.page.click("#desk button:text-is('Restore')")
    view.do("dualarm.design.idle()")
    assert shown(view, "objective") == pytest.approx(best, rel=1e-6)
    view.page.click("#desk button:text-is('Save')")
    view.page.wait_for_selector("text=Saved into")
    assert {"cell.yaml", "task.yaml", "result.json"} <= {f.name for f in pages._folder.iterdir()}


def test_the_page_asks_nobody_but_its_server_and_may_not(view, address):
    hosts = {urlsplit(url).netloc for url in view.requests if url.startswith("http")}
    assert hosts == {urlsplit(address).netloc}
    blocked = view.do("fetch('http://127.0.0.1:9/').then(() => false, () => true)")
    assert blocked
    assert any("Content Security Policy" in said for said in view.complaints)
    view.complaints.clear()


def test_a_second_page_stands_where_the_task_does(view, address):
    view.do("dualarm.design.set({'base2.x': -0.2}); dualarm.design.commit(); dualarm.design.idle()")
    with opened(address) as other:
        other.do("dualarm.design.idle()")
        assert shown(other, "objective") == pytest.approx(12.730887, abs=1e-4)
        other.do("dualarm.design.set({'base2.y': 0.1}); dualarm.design.commit()")
        other.do("dualarm.design.idle()")
    assert state(view)["change"]["base2.y"] == 0.0


def test_it_fits_a_phone(address):
    with opened(address, width=390, height=800) as phone:
        phone.do("dualarm.design.idle()")
        assert phone.do("document.documentElement.scrollWidth") <= 390
        assert phone.complaints == []

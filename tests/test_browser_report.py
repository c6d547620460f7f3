"""The report in a real browser: plots and robots lead each other."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from answers import changed, task
from browser import opened
from ns16_pair import motions, pair
from paper_case import TASK
from patience import wait_until
from test_report import results

from dualarm_pin.answer.verify import verified
from dualarm_pin.show import write_report
from dualarm_pin.task import Task

pytestmark = pytest.mark.browser
BAD = '<img src="http://evil.example/x.png">'


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "report.html"
    asked = replace(task(), record={"path": BAD})
    shown = {label: (asked, t) for label, (_, t) in results().items()}
    shown = {BAD if label == "result 1" else label: each for label, each in shown.items()}
    for label in ("result 0", "result 2"):
        unknown = changed(shown[label][1], singular_value=np.full(31, np.nan))
        shown[label] = (asked, unknown)
    write_report(file, shown, title="Three results")
    return file


@pytest.fixture(scope="module")
def view(file):
    with opened(file.as_uri(), 1440, 900) as view:
        yield view


def cursors(view):
    """Return the place of every cursor as a share of its plot's width."""
    return view.do(
        "dualarm.charts.map((c) => (Number(c.cursor.getAttribute('x1')) - c.m.l)"
        " / (c.w - c.m.l - c.m.r))"
    )


def test_report_is_offline_and_clean(view, file):
    assert file.stat().st_size < 8_000_000
    assert {url.split(":")[0] for url in view.requests[1:]} <= {"data", "blob"}
    assert view.complaints == []
    assert view.do("document.images.length") == 0


def test_every_plot_has_every_result(view):
    titles = view.page.locator("figcaption").all_inner_texts()
    assert titles[0].startswith("index: force [m²]")
    assert any(t.startswith("clearance") for t in titles)
    assert sum(t.startswith(("arm1/", "arm2/")) for t in titles) == 12
    counts = view.do("dualarm.charts.map((c) => c.svg.querySelectorAll('.curve').length)")
    singular = next(k for k, t in enumerate(titles) if t.startswith("smallest singular"))
    assert counts[singular] == 1
    assert set(counts[:singular] + counts[singular + 1 :]) == {3}
    assert BAD in view.do("dualarm.charts[0].spec.series.map((s) => s.name)")


def test_scrubber_moves_every_cursor(view):
    for t in (0.0, 0.37, 1.0):
        view.page.locator(".scrub").evaluate(
            "(e, t) => { e.value = t; e.dispatchEvent(new Event('input')) }", t
        )
        assert view.do("dualarm.time()") == pytest.approx(t)
        np.testing.assert_allclose(cursors(view), t, atol=0.005)


def test_click_on_a_plot_moves_the_robots(view):
    view.do("dualarm.select(0); dualarm.seek(0)")
    before = view.do("dualarm.linkPose('e2').position")
    picture = view.picture()
    box = view.page.locator(".chart svg").first.bounding_box()
    view.page.mouse.click(box["x"] + 0.62 * box["width"], box["y"] + 0.5 * box["height"])
    t = view.do("dualarm.time()")
    assert 0.5 < t < 0.7
    np.testing.assert_allclose(cursors(view), t, atol=0.005)
    after = view.do("dualarm.linkPose('e2').position")
    assert np.linalg.norm(np.subtract(after, before)) > 0.01
    assert (np.abs(view.picture() - picture).max(axis=2) > 30).sum() > 100
    cell, data = pair(), pair().model.createData()
    q, at = motions()[0][0], t * 30
    k = int(at)
    pin.framesForwardKinematics(cell.model, data, q[k] + (at - k) * (q[k + 1] - q[k]))
    np.testing.assert_allclose(after, data.oMf[cell.e2].translation, atol=1e-4)


def test_playing_moves_robots_and_cursors_together(view):
    view.do("dualarm.speed(4); dualarm.seek(0); dualarm.play()")
    wait_until(lambda: view.do("dualarm.time()") > 0, "playing")
    view.do("dualarm.pause()")
    t = view.do("dualarm.time()")
    assert t > 0
    np.testing.assert_allclose(cursors(view), t, atol=0.005)


def test_arc_length_axis_keeps_cursor_and_click_true(view):
    view.page.locator(".legend select").select_option("arc")
    view.do("dualarm.seek(0.5)")  # the middle of the fillet, by points as by length
    s = np.array(pair_path().arc_length)
    share = s[15] / s[-1]
    charts = cursors(view)
    np.testing.assert_allclose(charts[0], share, atol=0.005)
    box = view.page.locator(".chart svg").first.bounding_box()
    inner = view.do("[dualarm.charts[0].m.l, dualarm.charts[0].w, dualarm.charts[0].m.r]")
    x = inner[0] + s[6] / s[-1] * (inner[1] - inner[0] - inner[2])
    view.page.mouse.click(box["x"] + x, box["y"] + 30)
    assert view.do("dualarm.time()") == pytest.approx(6 / 30, abs=0.01)
    view.page.locator(".legend select").select_option("point")


def pair_path():
    return task().path


def test_choosing_a_result_is_seen_everywhere(view):
    view.page.locator(".legend [data-run='2']").click()
    assert view.page.locator(".readout b").inner_text() == "result 2"
    actives = view.do(
        "dualarm.charts.map((c) => c.svg.querySelector('.curve.active')?.dataset.name ?? null)"
    )
    assert {name for name in actives if name} == {"result 2"}
    assert view.page.locator("th.active").first.inner_text() == "result 2"
    view.do("dualarm.select(1)")
    assert view.page.locator(".readout b").inner_text() == BAD
    assert view.page.locator(".task").text_content().strip() == f"{{path: {BAD}}}"
    assert view.complaints == []


def test_phone_is_one_column(file):
    with opened(file.as_uri(), 390, 844, color_scheme="dark") as view:
        assert view.do("document.documentElement.scrollWidth <= innerWidth")
        player = view.page.locator("#player").bounding_box()
        plots = view.page.locator(".charts").bounding_box()
        assert plots["y"] >= player["y"] + player["height"] - 1
        assert view.complaints == []


def test_bodies_in_each_other_are_coloured_where_nothing_is_asked_too(tmp_path):
    q = motions()[0][0]
    cell, data = pair(), pair().model.createData()
    pin.framesForwardKinematics(cell.model, data, q[0])
    place = np.round(data.oMf[cell.e1].translation, 3).tolist()
    block = f"cell.objects={{block: {{box: [0.02, 0.02, 0.02], at: {{xyz: {place}}}}}}}"
    asked = Task.load(TASK, ["clearance=off", block])
    answer = verified(asked, q, method="m", solver="s")
    write_report(tmp_path / "off.html", {"off": (asked, answer)})
    with opened((tmp_path / "off.html").as_uri(), 1440, 900) as view:
        view.do("dualarm.seek(0)")
        near = view.do("dualarm.nearest()")
        assert "block" in near["names"]
        assert near["distance"] < 0.0
        assert {"arm1/link_6", "block"} <= set(near["lacking"])
        free = [i for i in range(31) if min(cell_distances(asked, q[i])) > 0.0]
        assert free
        view.do(f"dualarm.seek({free[0] / 30})")
        assert view.do("dualarm.nearest().lacking") == []


def cell_distances(asked, q):
    """Return the distances of what does not belong together by nature."""
    return asked.cell.distances(q)[asked.cell.apart_by_nature]


def test_the_nearest_bodies_are_drawn_where_they_are_and_coloured_where_too_near(tmp_path):
    """The line ends on the bodies, its length is the distance, and its curve follows the cursor."""
    asked = Task.load(TASK, ["clearance=0.25"])
    answer = verified(asked, motions()[0][0], method="m", solver="s")
    free = replace(asked, clearance=None)
    results = {
        "asked": (asked, answer),
        "off": (free, verified(free, answer.q, method="m", solver="s")),
    }
    write_report(tmp_path / "near.html", results)
    cell, q = asked.cell, answer.q
    with opened((tmp_path / "near.html").as_uri(), 1440, 900) as view:
        for i, place in ((4, 0.5), (20, 0.0)):
            view.do(f"dualarm.seek({(i + place) / 30})")
            near = view.do("dualarm.nearest()")
            at = (1 - place) * q[i] + place * q[i + 1]
            apart = [k for k in range(len(cell.pairs)) if cell.apart_by_nature[k]]
            seen = cell.distances(at)
            k = min(apart, key=lambda k: seen[k])
            assert near["names"] == list(cell.pairs[k])
            assert near["distance"] == pytest.approx(seen[k], abs=2e-4)
            ends = view.do(
                "dualarm.player.on_stage[0].nearest.balls.map((b) => b.position.toArray())"
            )
            assert np.linalg.norm(np.subtract(*ends)) == pytest.approx(seen[k], abs=2e-4)
            short = {b for k in apart if seen[k] < 0.2495 for b in cell.pairs[k]}
            assert short <= set(near["lacking"])
            tinted = view.do(
                "(() => { const v = dualarm.player.on_stage[0], all = v.robot.kinds.visual;"
                " const bad = all.filter((m) => m.material === v.nearest.warning);"
                " return [...new Set(bad.map((m) => m.userData.of))]; })()"
            )
            assert set(tinted) == set(near["lacking"])
        title = "nearest of arms, parts and objects; 0.25 m is asked for"
        assert any(title in text for text in view.page.locator("figcaption").all_inner_texts())
        view.do("dualarm.select(1)")
        assert view.do("dualarm.nearest().lacking") == []
        view.do("dualarm.show('distance', false)")
        assert not view.do("dualarm.player.on_stage[0].nearest.group.visible")
        assert view.complaints == []

"""A motion in the browser: real time, shares of the limits, traces, the trade of index and feed."""

import numpy as np
import pytest
from answers import answers
from browser import opened
from paper_case import TASK
from patience import wait_until
from test_motion_laws import TORQUE

from dualarm_pin.motion.make import make_motion
from dualarm_pin.show import write_report
from dualarm_pin.task import Task

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def motions():
    task = Task.load(TASK, ["motion={law: time_optimal}", TORQUE])
    found = {label: make_motion(task, answers()[label]) for label in ("result 0", "result 1")}
    return task, found


@pytest.fixture(scope="module")
def view(motions, tmp_path_factory):
    task, found = motions
    file = tmp_path_factory.mktemp("page") / "motion.html"
    shown = {label: (task, answers()[label]) for label in found}
    write_report(file, shown, title="Motions", motions=found)
    with opened(file.as_uri(), 1300, 900) as view:
        yield view


def test_it_is_offline_and_clean(view):
    assert view.complaints == []
    assert {url.split(":")[0] for url in view.requests[1:]} <= {"data", "blob"}


def test_seconds_follow_the_motion(view, motions):
    _, found = motions
    view.do("dualarm.select(0); dualarm.seek(1)")
    duration = found["result 0"].duration
    assert view.do("dualarm.seconds()") == pytest.approx(duration, rel=1e-5)
    view.do("dualarm.seek(0.5)")
    motion, s = found["result 0"], answers()["result 0"].arc_length
    expected = np.interp(s[15], motion.arc_length, motion.time)
    assert view.do("dualarm.seconds()") == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("speed", [0.1, 4.0])
def test_it_plays_in_real_time_times_a_factor(view, speed):
    view.do("dualarm.select(0); dualarm.seek(0)")
    passed = view.do(f"(dualarm.speed({speed}), dualarm.player.advance(100), dualarm.seconds())")
    assert passed == pytest.approx(0.1 * speed, rel=1e-3)


def test_plots_have_a_time_axis(view, motions):
    view.page.locator("select[aria-label='Horizontal axis']").select_option("time")
    values = view.do("dualarm.charts[0].spec.x.values")
    assert values[0] == 0.0
    assert values[-1] == pytest.approx(motions[1]["result 0"].duration, rel=1e-5)
    assert np.all(np.diff(values) > 0)


def test_shares_of_speed_and_torque_are_plotted_for_every_joint(view):
    titles = view.page.locator("figcaption").all_inner_texts()
    for what in ("joint speed", "joint torque"):
        k = next(k for k, title in enumerate(titles) if title.startswith(what))
        assert "%" in titles[k]
    series = view.do(
        "dualarm.charts.filter((c) => c.spec.title.startsWith('joint ')).map((c) => c.spec.series)"
    )
    assert [len(each) for each in series] == [12, 12]
    largest = max(max(one["values"]) for one in series[1])
    assert 50.0 < largest <= 100.1


def found_names(motions):
    return motions[1]["result 0"].summary.held_by


def test_the_strip_marks_what_holds_the_motion_back(view, motions):
    names = view.page.locator(".held-names span").all_inner_texts()
    assert names
    assert set(names) == set(found_names(motions))
    widths = view.do(
        "[...document.querySelectorAll('.held i')].map((i) => parseFloat(i.style.width))"
    )
    assert sum(widths) == pytest.approx(100.0, abs=0.1)


def test_traces_of_both_tips_can_be_shown(view):
    view.do("dualarm.show('traces', true)")
    assert view.do("dualarm.player.on_stage[0].marks.traces.map((t) => t.visible)") == [True, True]
    wanted = view.do("dualarm.seek(1), dualarm.linkPose('e2').position")
    last = view.do(
        "Array.from(dualarm.player.on_stage[0].marks.traces[1].geometry.attributes.position.array)"
        ".slice(-3)"
    )
    np.testing.assert_allclose(last, wanted, atol=1e-4)


def test_a_point_of_the_trade_opens_its_motion(view):
    view.do("dualarm.select(0)")
    points = view.page.locator(".trade-point")
    assert points.count() == 2
    points.nth(1).click()
    wait_until(lambda: view.do("dualarm.player.active") == 1, "the second result")

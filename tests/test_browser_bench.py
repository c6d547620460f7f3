"""The report of a batch in a real browser: one drawing, a selector, no network."""

import json
import shutil

import pytest
from browser import opened

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

from paper_case import TASK

from dualarm_pin.bench.batch import run_suite
from dualarm_pin.bench.report.page import write_report
from dualarm_pin.bench.suite import Suite

pytestmark = pytest.mark.browser
NASTY = '<img src="http://evil.example/x.png">'


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    tasks = [{"file": str(TASK), "name": f"task {i} {NASTY}"} for i in range(3)]
    for i, entry in enumerate(tasks):
        entry["overrides"] = {"grid": {"smoothness": [i + 1.0]}}
    suite = {
        "title": f"A batch {NASTY}",
        "tasks": tasks,
        "methods": [{"call": "bench_fakes:quick", "name": NASTY}],
    }
    (folder / "suite.yaml").write_text(json.dumps(suite))
    loaded = Suite.load(folder / "suite.yaml", allow_code=True)
    batch = run_suite(loaded, folder / "out", jobs=1)
    write_report(loaded, batch, "dualarm-pin bench suite.yaml")
    page = folder / "moved" / "report.html"
    page.parent.mkdir()
    shutil.move(folder / "out" / "report.html", page)
    shutil.rmtree(folder / "out")
    return page


@pytest.fixture(scope="module")
def view(file):
    with opened(file.as_uri(), 1280, 900) as view:
        yield view


def test_the_report_is_offline_and_clean(view, file):
    assert file.stat().st_size < 8_000_000
    assert {url.split(":")[0] for url in view.requests[1:]} <= {"data", "blob"}
    assert view.complaints == []
    assert view.do("document.images.length") == 0
    assert view.page.locator("h1").first.inner_text() == f"A batch {NASTY}"


def test_all_tasks_share_one_drawing_with_a_selector(view):
    assert view.do("document.querySelectorAll('canvas').length") == 1
    assert len(view.do("dualarm.runs")) == 3
    assert view.page.locator(".runs li").count() == 3
    view.page.locator(".runs input[type=radio]").nth(2).check()
    assert view.do("dualarm.player.active") == 2
    assert view.picture().std() > 5.0, "nothing is drawn"


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_fits_laptop_and_phone_in_both_schemes(file, width, scheme):
    with opened(file.as_uri(), width, 800, color_scheme=scheme) as view:
        assert view.do("document.documentElement.scrollWidth") <= width
        ground, ink = (
            view.do(f"getComputedStyle(document.body).{key}")
            for key in ("backgroundColor", "color")
        )
        assert abs(brightness(ground) - brightness(ink)) > 150


def brightness(colour):
    parts = colour.removeprefix("rgb(").removeprefix("rgba(").rstrip(")").split(",")
    return sum(float(part) for part in parts[:3]) / 3.0

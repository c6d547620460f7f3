"""Names from strangers are text on every page: markup in each of them stays markup to read."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path

import pytest
from browser import opened
from test_bad_robots import SOUND

from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.cli import main
from dualarm_pin.planners.methods import plan
from dualarm_pin.show import write_report
from dualarm_pin.task import Task

BAD = "<img src=x onerror=window.hit=1>"


def quoted(text: str) -> str:
    return escape(text, quote=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot whose name, links and joints are markup, in a cell and a task of such names."""
    folder = tmp_path_factory.mktemp("names")
    names = {
        "small",
        "base",
        "upper",
        "fore",
        "hand",
        "tip",
        "shoulder",
        "elbow",
        "slide",
        "flange",
    }
    text = SOUND
    for name in names:
        text = text.replace(f'"{name}"', f'"{quoted(f"{name} {BAD}")}"')
    (folder / "robot.urdf").write_text(text)
    (folder / f"task {BAD}.yaml").write_text(
        f"""
cell:
  name: "cell {BAD}"
  arms:
    arm1: {{urdf: robot.urdf, tip: "tip {BAD}"}}
    arm2: {{urdf: robot.urdf, tip: "tip {BAD}", base: {{xyz: [0.6, 0, 0], rpy_deg: [0, 0, 180]}}}}
path:
  polyline: {{vertices: [[0, 0, 0.05], [0.01, 0, 0.05]], points: 3}}
  free: rotation
constraints: [{{above: {{frame: arm1/tip, z: -9}}}}]
method: local
"""
    )
    task = Task.load(folder / f"task {BAD}.yaml")
    save_result(folder / f"result {BAD}", task, plan(task, "local"))
    return folder


def test_no_page_holds_a_name_as_markup(folder: Path) -> None:
    """The report, and the picture of the cell: the markup is in neither of their sources."""
    for arguments in (
        ["view", str(folder / f"result {BAD}"), "--html", str(folder / "report.html")],
        ["check", str(folder / f"task {BAD}.yaml"), "--html", str(folder / "check.html")],
    ):
        with pytest.raises(SystemExit) as end:
            main(arguments)
        assert end.value.code == 0
    for name in ("report.html", "check.html"):
        text = (folder / name).read_text()
        assert BAD not in text
        assert quoted(BAD) in re.search(r"<title>(.*?)</title>", text)[1]  # type: ignore[index]


@pytest.mark.browser
def test_a_browser_makes_nothing_of_names(folder: Path) -> None:
    page = folder / "both.html"
    result = load_result(folder / f"result {BAD}")
    write_report(page, {f"{BAD} {k}": result for k in (1, 2)}, title=BAD)
    with opened(page.as_uri(), 1200, 800) as view:
        assert view.do("window.hit") is None
        assert view.do("document.querySelectorAll('img, [onerror]').length") == 0
        assert view.complaints == []
        titles = " ".join(view.page.locator("figcaption").all_inner_texts())
        assert f"arm1/elbow {BAD}" in titles  # it is there, as text

"""Draw the pictures of the README: `python docs/make_pictures.py`.

Solves the task of the paper by three methods, takes `scene.png` from the report's own animation in
headless Chromium and draws `plots.png` with `dualarm_pin.plots`. Needs the `dev` extra and
Chromium (Debian: chromium).
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from matplotlib.figure import Figure

from dualarm_pin import plots
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.planners import plan_global, plan_local, plan_two_stage
from dualarm_pin.task import Task
from dualarm_pin.trajectory import Trajectory
from dualarm_pin.viewer import Run, write_player

HERE = Path(__file__).resolve().parent
FLAGS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
CLEAN = """
document.querySelector('.panel').remove();
document.querySelector('.bar').remove();
document.querySelector('.heading').remove();
"""


def solve(task: Task) -> dict[str, Trajectory]:
    """Return the answers of three methods by label."""
    two_stage = plan_two_stage(task)
    return {
        "whole path": plan_global(task, effort="quick"),
        "two-stage (the paper)": two_stage,
        "pseudo-inverse, same start": plan_local(task, two_stage.q[0], variant="free"),
    }


def scene(task: Task, answer: Trajectory, file: Path) -> None:
    """Take the picture of an answer, in the middle of the fillet."""
    from playwright.sync_api import sync_playwright

    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        sys.exit("Chromium is not installed (Debian: apt-get install chromium)")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        page_file = Path(folder) / "page.html"
        run = Run("whole path", answer.q, answer.index)
        write_player(page_file, task.cell, task.path, [run], title="")
        browser = driver.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 600}, color_scheme="light")
        page.goto(page_file.as_uri())
        page.evaluate("dualarm.ready.then(() => true)")
        page.evaluate(CLEAN)
        page.evaluate("dualarm.seek(0.5); dualarm.show('force', true)")
        page.evaluate("dualarm.show('velocity', true); dualarm.look('corner')")
        page.evaluate("dualarm.player.stage.viewer.camera.zoom = 1.18; dualarm.player.stage.draw()")
        page.wait_for_timeout(3000)  # until the fine picture is drawn
        page.screenshot(path=file)
        browser.close()


def curves(answers: dict[str, Trajectory]) -> Figure:
    """Return the index along the path."""
    return plots.figure_index(
        [plots.Curve(label, t.index, t.arc_length) for label, t in answers.items()],
        title="Index along the corner of the paper (lower is better)",
    )


def main() -> int:
    """Solve, draw, write."""
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    answers = solve(task)
    scene(task, answers["whole path"], HERE / "scene.png")
    curves(answers).savefig(HERE / "plots.png", dpi=160, metadata={"Software": None})
    for file in ("scene.png", "plots.png"):
        sys.stdout.write(f"docs/{file}: {(HERE / file).stat().st_size / 1000:.0f} kB\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

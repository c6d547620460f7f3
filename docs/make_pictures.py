"""Make the pictures of the README: `python docs/make_pictures.py`.

`scene.png` is the player page of the package, drawn by headless Chromium (playwright and a
Chromium are needed: Debian's, or the one that DUALARM_PIN_CHROMIUM names); `plots.png` compares
the methods as in Fig. 4 of the paper.
"""

import io
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image, ImageDraw
from playwright.sync_api import Browser, sync_playwright

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.paper import RANDOM_STARTS, reproduce
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.show import plots, write_player
from dualarm_pin.show.plots.style import dress
from dualarm_pin.task import Task

HERE = Path(__file__).resolve().parent
MOST_BYTES = 300_000
WIDTH, HEIGHT, SCALE = 1000, 520, 2
# Software rendering, the same picture on every machine.
FLAGS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
# Only the stage: no heading, panel or clock in a still picture.
STILL = ".heading, .panel, .bar { display: none !important } .canvas { right: 0 !important }"
# World z up; the eye looks across the line of the bases, a little from above.
CAMERA = """([eye, target, fov]) => {
  const stage = dualarm.player.stage, camera = stage.viewer.camera;
  camera.fov = fov;
  camera.updateProjectionMatrix();
  stage.viewer.controls.target.set(target[0], target[2], -target[1]);
  camera.position.set(eye[0], eye[2], -eye[1]);
  stage.viewer.controls.update();
  dualarm.player.render();
}"""
WIDE = [(-0.1, -3.9, 2.0), (1.42, 0.0, 0.8), 30.0]  # eye and target [m], field of view [deg]
CLOSE = [(0.26, 1.16, 0.77), (0.9, 0.1, 0.49), 28.0]
INSET = (300, 220, 20)  # width, height, from the upper right corner
AT = 0.12  # place on the path


def main() -> None:
    """Make both."""
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    best = plan_global(task, effort="quick", seed=0)
    draw_scene(task, best, HERE / "scene.png")
    starts = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    draw_plots(starts, HERE / "plots.png")


def draw_scene(task: Task, best: Trajectory, file: Path) -> None:
    """Draw both robots, the path and the ellipsoids at one place of the path."""
    page_file = HERE / "scene.html"
    write_player(page_file, task, {"best": best}, title="scene")
    try:
        with open_browser() as browser:
            wide = _still(browser, page_file, (WIDTH, HEIGHT), WIDE, ["force", "velocity"])
            close = _still(browser, page_file, INSET[:2], CLOSE, [])
    finally:
        page_file.unlink()
    _paste_inset(wide, close)
    write_picture(file, wide)


@contextmanager
def open_browser() -> Iterator[Browser]:
    """Start headless Chromium."""
    found = map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))
    chromium = os.environ.get("DUALARM_PIN_CHROMIUM") or next(filter(None, found), None)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=FLAGS)
        yield browser
        browser.close()


def _still(
    browser: Browser, page: Path, size: tuple[int, int], camera: list[Any], on: list[str]
) -> Image.Image:
    """Return one picture of the page."""
    view = browser.new_page(
        viewport={"width": size[0], "height": size[1]},
        device_scale_factor=SCALE,
        color_scheme="light",
    )
    view.goto(page.as_uri())
    view.evaluate("dualarm.ready.then(() => true)")
    view.add_style_tag(content=STILL)
    view.evaluate(f"dualarm.seek({AT})")
    # Frames would hide the ellipsoids, and ellipsoids the path.
    view.evaluate(f"dualarm.show('frames', {str(not on).lower()})")
    for name in on:
        view.evaluate(f"dualarm.show('{name}', true)")
    view.wait_for_timeout(1500)  # until it draws finely again
    view.evaluate(CAMERA, camera)
    view.wait_for_timeout(1500)
    picture = Image.open(io.BytesIO(view.screenshot())).convert("RGB")
    view.close()
    return picture


def _paste_inset(picture: Image.Image, close: Image.Image) -> None:
    """Put the close view into the upper right corner, with a frame and round corners."""
    radius, line = 14 * SCALE, 2 * SCALE
    mask = Image.new("L", close.size, 0)
    box = (0, 0, close.width - 1, close.height - 1)
    ImageDraw.Draw(mask).rounded_rectangle(box, radius, fill=255)
    framed = close.copy()
    ImageDraw.Draw(framed).rounded_rectangle(box, radius, outline="#5b626b", width=line)
    edge = INSET[2] * SCALE
    picture.paste(framed, (picture.width - close.width - edge, edge), mask)


def draw_plots(starts: int, file: Path) -> None:
    """Compare the methods along the path, as Fig. 4 and Fig. 5 do."""
    found = reproduce(starts=starts).trajectories
    random = [f"pseudo-inverse, free, random {k}" for k in range(1, RANDOM_STARTS + 1)]
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    lines = {
        "whole path at once": "whole path",
        "two-stage, polished": "two-stage, polished",
        "two-stage": "two-stage",
        "pseudo-inverse": "pseudo-inverse, free",
    }
    for k, (shown, name) in enumerate(lines.items()):
        _curve(left, found[name], shown, k)
    _curve(right, found["whole path"], "whole path at once", 0)
    _curve(right, found["pseudo-inverse, free, best first"], "pseudo-inverse from its start", 3)
    for k, name in enumerate(random):
        _curve(right, found[name], f"from random start {k + 1}", 4 + k)
    for ax, title in (
        (left, "The whole task against step by step"),
        (right, "Step by step, from several starts"),
    ):
        dress(ax, "point")
        ax.set_title(title, loc="left", fontsize=11)
        ax.set_ylim(0, 1.45 * ax.get_ylim()[1])  # room for the legend above the curves
        ax.legend(frameon=False, fontsize=8.5, loc="upper left")
    left.set_ylabel("index $c$ [m²], lower is better")
    picture = io.BytesIO()
    figure.savefig(picture, dpi=160, metadata={"Software": None})
    write_picture(file, Image.open(picture).convert("RGB"))


def _curve(ax: Axes, answer: Trajectory, label: str, k: int) -> None:
    plots.draw_curve(ax, k, f"{label} (mean {answer.mean_index:.2f})", answer, answer.index)


def write_picture(file: Path, picture: Image.Image) -> None:
    """Write a picture in 256 colours, and refuse one too large for a README."""
    few = picture.quantize(256, method=Image.Quantize.MEDIANCUT, kmeans=3)
    few.save(file, optimize=True)
    size = file.stat().st_size
    print(f"{file.name}: {picture.width} x {picture.height}, {size / 1000:.0f} kB")
    if size > MOST_BYTES:
        raise SystemExit(f"{file} is larger than {MOST_BYTES} bytes")


if __name__ == "__main__":
    main()

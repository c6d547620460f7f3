"""Solve the tasks of the gallery and draw its pictures: `python docs/make_gallery.py [NAME]`.

The results stand in `docs/results`, with paths that hold in this repository; the build of the
manual makes the live pages of them. `--pictures` draws the pictures alone.
"""

import argparse
import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from generate import RESULTS, live_page
from make_pictures import open_browser, write_picture
from PIL import Image

from dualarm_pin.files.resources import urdf_folder

ASSETS = RESULTS.parent / "manual" / "assets"
TASKS = urdf_folder() / "tasks"
QUICK = ["--effort", "quick"]
SOLVES = {
    "corner/at_once": [TASKS / "paper_corner.yaml", *QUICK],
    "corner/step_by_step": [TASKS / "paper_corner.yaml", "--method", "local", "--solver", "qp"],
    "circle": [TASKS / "circle.yaml", *QUICK],
    "curve": [TASKS / "curve_1.yaml", *QUICK],
    "table": [RESULTS.parent / "table.yaml", *QUICK],
}
PLACES = {"corner": 0.12, "circle": 0.4, "curve": 0.3, "table": 0.7}  # on the path
SIZE = (720, 440)
# Only the stage, over the whole window: no heading, clock or tables in a still picture.
STILL = """.heading, .panel, .bar { display: none !important }
.stage { position: fixed !important; inset: 0; z-index: 9 } .canvas { right: 0 !important }"""
DRESS = """(css) => { const sheet = new CSSStyleSheet(); sheet.replaceSync(css);
  document.adoptedStyleSheets = [sheet]; }"""  # the policy of the page refuses a <style>


def main() -> None:
    """Solve and draw all, or one."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", default=list(PLACES))
    parser.add_argument("--pictures", action="store_true")
    given = parser.parse_args()
    for name in given.names:
        if not given.pictures:
            solve(name)
        draw(name)


def solve(gallery: str) -> None:
    """Solve what stands on one page."""
    for name, arguments in SOLVES.items():
        if name.split("/")[0] != gallery:
            continue
        folder = RESULTS / name
        shutil.rmtree(folder, ignore_errors=True)
        command = [sys.executable, "-m", "dualarm_pin", "solve", *map(str, arguments)]
        subprocess.run([*command, "--out", str(folder)], check=True)
        for table in ("trajectory.csv", "motion.csv"):  # the page reads the archives
            (folder / table).unlink(missing_ok=True)
        task = folder / "task.yaml"
        up = "/".join([".."] * (len(folder.relative_to(RESULTS).parts) + 2))
        task.write_text(task.read_text().replace(f"{urdf_folder()}/", f"{up}/urdf/"))


def draw(gallery: str) -> None:
    """Draw the picture of one page."""
    with tempfile.TemporaryDirectory() as folder, open_browser() as browser:
        file = Path(folder) / "page.html"
        file.write_bytes(live_page(gallery))
        width, height = SIZE
        page = browser.new_page(viewport={"width": width, "height": height}, color_scheme="light")
        page.goto(file.as_uri())
        page.evaluate("dualarm.ready.then(() => true)")
        page.evaluate(DRESS, STILL)
        page.evaluate(f"dualarm.seek({PLACES[gallery]})")
        page.wait_for_timeout(2500)  # until it draws finely again
        picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    write_picture(ASSETS / f"gallery_{gallery}.png", picture)


if __name__ == "__main__":
    main()

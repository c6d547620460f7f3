"""Make the moving picture of the design page: `python docs/make_moving_picture.py`.

`design.webp` is `dualarm-pin design` on the task of the paper, in headless Chromium: base 2 moves
nearer, then aside, then too far away. Each picture waits for its motion and for what the search
behind it finds, so that it does not depend on the speed of the machine.
"""

import io
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Page

from dualarm_pin.design.server import Pages
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.show import serving
from dualarm_pin.task import Task

sys.path.insert(0, str(Path(__file__).resolve().parent))
from make_pictures import open_browser

HERE = Path(__file__).resolve().parent
MOST_BYTES = 1_500_000
WIDTH, HEIGHT, SHARE = 1120, 680, 0.75  # of the page; of it in the picture
AT = 0.6  # place on the path
STEP_MS, REST_MS = 160, 1500
NEARER = [("base2.x", float(x)) for x in np.linspace(0.0, -0.4, 15)]
ASIDE = [("base2.y", float(y)) for y in np.linspace(0.0, 0.3, 9)[1:]]
AWAY = [("base2.x", float(x)) for x in np.linspace(-0.4, 1.7, 13)[1:]]


def main() -> None:
    """Make it."""
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    frames: list[Image.Image] = []
    times: list[int] = []
    with (
        tempfile.TemporaryDirectory() as folder,
        Pages(task, Path(folder)) as pages,
        serving(pages.open, 0, pages.talk) as address,
        open_browser() as browser,
    ):
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.set_default_timeout(0)
        page.goto(address)
        page.evaluate("dualarm.ready.then(() => dualarm.design.idle())")
        page.evaluate("(t) => dualarm.seek(t)", AT)
        for moves in (NEARER, ASIDE, AWAY):
            for name, value in moves:
                page.evaluate("(change) => dualarm.design.set(change)", {name: value})
                frames.append(_picture(page))
                times.append(STEP_MS)
            page.evaluate("dualarm.design.commit()")
            frames.append(_picture(page))
            times.append(REST_MS)
    file = HERE / "design.webp"
    frames[0].save(
        file, save_all=True, append_images=frames[1:], duration=times, loop=0, quality=55, method=6
    )
    size = file.stat().st_size
    print(f"{file}: {len(frames)} pictures, {size} bytes")
    if size > MOST_BYTES:
        raise SystemExit(f"larger than {MOST_BYTES} bytes")


def _picture(page: Page) -> Image.Image:
    page.evaluate("dualarm.design.idle()")
    page.evaluate("() => { const p = dualarm.player; p.stage.quality(true); p.render(); }")
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    data = page.screenshot(scale="css")
    image = Image.open(io.BytesIO(data)).convert("RGB")
    return image.resize((int(WIDTH * SHARE), int(HEIGHT * SHARE)), Image.Resampling.LANCZOS)


if __name__ == "__main__":
    main()

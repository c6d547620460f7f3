"""A page in headless Chromium, with what it asked for and what it complained about."""

import atexit
import base64
import io
import os
import shutil
from contextlib import contextmanager
from functools import cache

import numpy as np
import pytest
from patience import LONG

CHROMIUM = os.environ.get("DUALARM_PIN_CHROMIUM") or next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
# Software rendering, the same on every machine; playwright's own flags give a console warning.
FLAGS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


class Opened:
    """A page with its requests and its console."""

    def __init__(self, page):
        self.page, self.requests, self.complaints = page, [], []
        page.on("request", lambda r: self.requests.append(r.url))
        page.on("pageerror", lambda e: self.complaints.append(str(e)))
        page.on("console", self._heard)

    def _heard(self, message):
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def do(self, script):
        return self.page.evaluate(script)

    def picture(self):
        """Return the drawing as an array (rows, columns, 3), rendered now, on black."""
        from PIL import Image

        data = self.do(
            "(() => { const p = dualarm.player; p.stage.quality(false); p.render();"
            " return p.stage.viewer.renderer.domElement.toDataURL(); })()"
        )
        image = Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGBA")
        flat = Image.new("RGBA", image.size, (0, 0, 0, 255))
        return np.asarray(Image.alpha_composite(flat, image).convert("RGB")).astype(int)


@cache
def chromium():
    """Return the browser of this test process, or skip the test and say why."""
    playwright = pytest.importorskip("playwright.sync_api")
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed (Debian: apt-get install chromium)")
    driver = playwright.sync_playwright().start()
    browser = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
    atexit.register(lambda: (browser.close(), driver.stop()))
    return browser


@contextmanager
def opened(url, width=1000, height=700, **options):
    """Open a page and wait until its first picture is there."""
    page = chromium().new_page(viewport={"width": width, "height": height}, **options)
    page.set_default_timeout(1000 * LONG)
    try:
        view = Opened(page)
        page.goto(url)
        view.do("dualarm.ready.then(() => true)")
        yield view
    finally:
        page.close()

"""A drag on the design page in headless Chromium, and what it shows meanwhile."""

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass

from browser import opened

# Where a part of the gizmo is on the screen: near its end, where nothing else is hit first.
SPOT = """(part) => { const d = dualarm.design, g = d.gizmo, T = MeshCat.THREE, s = g.size;
  g.stage.viewer.camera.updateMatrixWorld();
  const p = {x: [.9*s,0,0], y: [0,.9*s,0], z: [0,0,.9*s], yaw: [-.438*s,.438*s,0]}[part];
  const v = new T.Vector3(...p).applyMatrix4(g.group.matrixWorld).project(g.stage.viewer.camera);
  const b = g.stage.viewer.renderer.domElement.getBoundingClientRect();
  return [b.left + (v.x + 1) / 2 * b.width, b.top + (1 - v.y) / 2 * b.height]; }"""
# Pointer events made in the page: they come as often as a hand makes them, whatever the browser's
# driver does meanwhile.
_DRAG = """([x, y, ms]) => new Promise((done) => {
  const d = dualarm.design, canvas = d.gizmo.stage.viewer.renderer.domElement;
  const begun = performance.now(), before = d.drawing.ages.length, pointerId = d.gizmo.held.id;
  const timer = setInterval(() => {
    const t = performance.now() - begun, a = 2 * Math.PI * t / 4000;
    if (t > ms) { clearInterval(timer); done(d.drawing.ages.slice(before)); return; }
    const at = {clientX: x - 60 * Math.sin(a), clientY: y - 15 * Math.sin(a)};
    canvas.dispatchEvent(new PointerEvent("pointermove", {bubbles: true, pointerId, ...at}));
  }, 1000 / 60); })"""


@dataclass(frozen=True)
class Dragged:
    """What a drag showed.

    Attributes:
        shown: Poses a second.
        ages: From each pose to its picture [ms].
        left_out: Poses that were answered and not shown, because they would have been too old.
    """

    shown: float
    ages: list[float]
    left_out: int


def drag(view, seconds=5.0):
    """Drag base 2 to and fro along x on a page that is open."""
    view.do("dualarm.design.idle()")
    x, y = view.page.evaluate(SPOT, "x")
    view.page.mouse.move(x, y)
    view.page.mouse.down()
    before = view.do("dualarm.design.drawing.late")
    ages = view.page.evaluate(_DRAG, [x, y, 1000.0 * seconds])
    left_out = view.do("dualarm.design.drawing.late") - before
    view.page.mouse.up()
    view.do("dualarm.design.idle()")
    return Dragged(len(ages) / seconds, ages, left_out)


def dragged_page(task, seconds=5.0):
    """Drag base 2 on the page of `dualarm-pin design TASK`, with a server of its own."""
    with tempfile.TemporaryDirectory() as folder:
        program = subprocess.Popen(
            [sys.executable, "-m", "dualarm_pin", "design", str(task), "--no-browser",
             "--out", folder],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        try:
            address = re.match(r"(http\S+)", program.stdout.readline())[1]
            with opened(address) as view:
                return drag(view, seconds)
        finally:
            program.terminate()
            program.wait()

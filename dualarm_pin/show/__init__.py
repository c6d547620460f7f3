"""See it: both arms in a browser, along the path, from one file or a local address.

The picture is meshcat's viewer (three.js); the motion is our own script, which turns every joint by
the joint angles themselves. So links hold together between the path points too: the poses are
those of Pinocchio at linearly interpolated q. Figures are those that stand in the answer: none is
computed again here. Only where the nearest two bodies are is found anew, for the picture.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from dualarm_pin.show.live import serve, serving
from dualarm_pin.show.player import Player, player_page, posture_page, write_player
from dualarm_pin.show.report import report_page, write_report
from dualarm_pin.show.scene import Scene

if TYPE_CHECKING:
    from dualarm_pin.show import plots as plots

__all__ = [
    "Player",
    "Scene",
    "player_page",
    "plots",
    "posture_page",
    "report_page",
    "serve",
    "serving",
    "write_player",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Load `plots` when it is first used: it takes matplotlib along."""
    if name == "plots":
        return import_module("dualarm_pin.show.plots")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

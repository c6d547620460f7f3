"""See it: both arms in a browser, along the path, from one file or a local address.

The picture is meshcat's viewer (three.js); the motion is our own script, which turns every joint by
the joint angles themselves. So links hold together between the path points too: the poses are
those of Pinocchio at linearly interpolated q.
"""

from dualarm_pin.show.live import serve, serving
from dualarm_pin.show.notebook import Player
from dualarm_pin.show.player import player_page, write_player
from dualarm_pin.show.report import report_page, write_report
from dualarm_pin.show.report_result import Result, result_of
from dualarm_pin.show.scene import Run, Scene, build_scene

__all__ = [
    "Player",
    "Result",
    "Run",
    "Scene",
    "build_scene",
    "player_page",
    "report_page",
    "result_of",
    "serve",
    "serving",
    "write_player",
    "write_report",
]

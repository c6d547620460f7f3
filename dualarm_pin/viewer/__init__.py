"""See it: both arms in a browser, along the path, from one file or a local address.

The picture is meshcat's viewer (three.js); the motion is our own script, which turns every joint by
the joint angles themselves. So links hold together between the path points too: the poses are
those of Pinocchio at linearly interpolated q.
"""

from dualarm_pin.viewer.inline import Player
from dualarm_pin.viewer.live import serve, serving
from dualarm_pin.viewer.player import player_page, write_player
from dualarm_pin.viewer.scene import Run, Scene, build_scene

__all__ = [
    "Player",
    "Run",
    "Scene",
    "build_scene",
    "player_page",
    "serve",
    "serving",
    "write_player",
]

"""Programs for robot controllers: written, read back and checked before anything is kept.

A format is one entry of `formats.FORMATS`: a writer and the reader of what it wrote. The joints of
what was read are put through the kinematics again, as the controller will run them, and compared
with the relative path of the motion.
"""

from dualarm_pin.exports.exported import Exported
from dualarm_pin.exports.format import Axes, Chord, Format
from dualarm_pin.exports.formats import FORMATS
from dualarm_pin.exports.make_program import export
from dualarm_pin.exports.program import Points, Program

__all__ = ["FORMATS", "Axes", "Chord", "Exported", "Format", "Points", "Program", "export"]

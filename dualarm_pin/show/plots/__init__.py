"""Figures for papers: matplotlib, colours safe for colour-blind readers, units on every axis.

Every function returns a `matplotlib.figure.Figure` that belongs to nobody else: pyplot is never
imported, so no window opens and no global list of figures grows. `save` writes SVG and PNG whose
bytes depend on the figure alone.
"""

from dualarm_pin.show.plots.curves import draw_curve, figure_clearance, figure_index
from dualarm_pin.show.plots.joints import figure_joints, figure_steps
from dualarm_pin.show.plots.paths import figure_path
from dualarm_pin.show.plots.style import COLOURS, save

__all__ = [
    "COLOURS",
    "draw_curve",
    "figure_clearance",
    "figure_index",
    "figure_joints",
    "figure_path",
    "figure_steps",
    "save",
]

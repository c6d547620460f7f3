"""What changes along the path, several answers on the same axes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.show.plots.style import COLOURS, DASHES, finish, plot

Along = Literal["point", "arc_length"]


def figure_index(
    answers: Mapping[str, Trajectory],
    *,
    title: str = "",
    quantity: str = "index $c$",
    units: str = "m²",
    along: Along = "point",
) -> Figure:
    """Compare the index of several answers along the path (Fig. 4, Fig. 5), with their means.

    Args:
        answers: By what the legend says.
        title: Title of the figure.
        quantity: What the vertical axis shows.
        units: Its units.
        along: Path point (from 1) or arc length on the horizontal axis.
    """
    figure, ax = plot(4.0)
    for k, (label, answer) in enumerate(answers.items()):
        mean = answer.mean_index
        draw_curve(ax, k, f"{label} (mean {mean:.3g})", answer, answer.index, along)
        ax.axhline(mean, xmin=0.97, lw=2.5, color=COLOURS[k % 7], solid_capstyle="butt")
    finish(ax, title, f"{quantity} [{units}]" if units else quantity, along)
    ax.set_ylim(bottom=0, top=ax.get_ylim()[1] * 1.08)
    return figure


def figure_clearance(
    answers: Mapping[str, Trajectory], *, title: str = "", along: Along = "point"
) -> Figure:
    """Compare the smallest distance between the links [m]; below zero they collide.

    Args:
        answers: By what the legend says.
        title: Title of the figure.
        along: Path point (from 1) or arc length on the horizontal axis.

    Raises:
        InputError: The distances of an answer are not known.
    """
    figure, ax = plot(4.0)
    lowest = 0.0
    for k, (label, answer) in enumerate(answers.items()):
        clearance = answer.checked.clearance
        if clearance is None:
            raise InputError("its clearance is unknown: geometry is missing", field=label)
        draw_curve(ax, k, label, answer, clearance.distance, along)
        lowest = min(lowest, clearance.least)
    finish(ax, title, "clearance [m]", along)
    ax.set_ylim(bottom=lowest * 1.1, top=ax.get_ylim()[1] * 1.08)
    if lowest < 0:
        ax.axhspan(lowest * 1.1, 0, color=COLOURS[1], alpha=0.12, lw=0)
        ax.text(0.01, 0.02, "collision", transform=ax.transAxes, color=COLOURS[1], fontsize=9)
    return figure


def draw_curve(
    ax: Axes, k: int, label: str, answer: Trajectory, values: Array, along: Along = "point"
) -> None:
    """Draw values (h,) of an answer in colour and dash k."""
    x = np.arange(1.0, len(values) + 1) if along == "point" else answer.arc_length
    ax.plot(x, values, lw=2, label=label, color=COLOURS[k % 7], linestyle=DASHES[k % 7])

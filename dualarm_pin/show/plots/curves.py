"""What changes along the path, several motions on the same axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from dualarm_pin.arrays import Array
from dualarm_pin.errors import ShapeError
from dualarm_pin.show.plots.style import COLOURS, DASHES, dress, say


@dataclass(frozen=True, eq=False)
class Curve:
    """One line of a comparison.

    Attributes:
        label: What the legend says.
        index: Value at each path point, shape (h,).
        arc_length: Arc length of each point, shape (h,) [m]; needed for `along="arc_length"`.
    """

    label: str
    index: Array
    arc_length: Array | None = None


def figure_index(
    curves: Sequence[Curve],
    *,
    title: str = "",
    quantity: str = "index $c$",
    units: str = "m²",
    along: Literal["point", "arc_length"] = "point",
    means: bool = True,
    zero: bool = True,
) -> Figure:
    """Compare the index of several motions along the path (Fig. 4, Fig. 5).

    Args:
        curves: One per motion.
        title: Title of the figure.
        quantity: What the vertical axis shows.
        units: Its units.
        along: Path point (from 1) or arc length on the horizontal axis.
        means: Mark the mean of each curve over the points at the right edge.
        zero: Let the vertical axis start at zero.

    Raises:
        ShapeError: A curve has no arc length where it is needed, or another length than its values.
    """
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    ax = figure.add_subplot()
    for k, curve in enumerate(curves):
        y = np.asarray(curve.index, dtype=float)
        label = f"{curve.label} (mean {y.mean():.3g})" if means else curve.label
        x = _along(curve, along)
        ax.plot(x, y, lw=2, label=label, color=COLOURS[k % 7], linestyle=DASHES[k % 7])
        if means:
            ax.axhline(y.mean(), xmin=0.97, lw=2.5, color=COLOURS[k % 7], solid_capstyle="butt")
    dress(ax, along)
    ax.set_ylabel(f"{quantity} [{units}]" if units else quantity)
    if zero:
        ax.set_ylim(bottom=0, top=ax.get_ylim()[1] * 1.08)
    say(ax, title)
    ax.legend(frameon=False, fontsize=9, loc="best")
    return figure


def figure_clearance(
    curves: Sequence[Curve],
    *,
    title: str = "",
    along: Literal["point", "arc_length"] = "point",
) -> Figure:
    """Compare the smallest distance between the links [m]; below zero they collide.

    Raises:
        ShapeError: As in `figure_index`.
    """
    figure = figure_index(
        curves, title=title, quantity="clearance", units="m", along=along, means=False
    )
    ax = figure.axes[0]
    lowest = min(0.0, *(float(np.min(curve.index)) for curve in curves))
    ax.set_ylim(bottom=lowest * 1.1)
    if lowest < 0:
        ax.axhspan(lowest * 1.1, 0, color=COLOURS[1], alpha=0.12, lw=0)
        ax.text(0.01, 0.02, "collision", transform=ax.transAxes, color=COLOURS[1], fontsize=9)
    return figure


def _along(curve: Curve, along: str) -> Array:
    count = len(curve.index)
    if along == "point":
        return np.arange(1.0, count + 1)
    if curve.arc_length is None or len(curve.arc_length) != count:
        raise ShapeError(
            f"arc_length of {curve.label!r} must have one value per point ({count})",
            field="arc_length",
        )
    return curve.arc_length

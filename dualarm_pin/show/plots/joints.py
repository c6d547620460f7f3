"""Joint motions within their bounds, and their steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from dualarm_pin.arrays import Array
from dualarm_pin.errors import ShapeError
from dualarm_pin.show.plots.style import ALONG, COLOURS, DASHES, FAINT, INK, dress, say

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell


@dataclass(frozen=True, eq=False)
class Motion:
    """One joint motion of a comparison: label and q (h, n) in the columns of the cell."""

    label: str
    q: Array


def figure_joints(cell: Cell, motions: Sequence[Motion], *, title: str = "") -> Figure:
    """Draw every joint within its bounds, one small plot per joint, one column per arm.

    Angles are in degrees, prismatic joints in metres.

    Raises:
        ShapeError: A motion has other columns than the cell.
    """
    for motion in motions:
        _check_columns(cell, motion)
    owners = ("arm1", "arm2", "common")
    columns = [[k for k, j in enumerate(cell.joints) if j.arm == arm] for arm in owners]
    columns = [column for column in columns if column]
    height = max(map(len, columns))
    figure = Figure(figsize=(3.6 * len(columns), 1.05 * height + 1.0), layout="constrained")
    grid = figure.subplots(height, len(columns), squeeze=False, sharex=True)
    for c, column in enumerate(columns):
        for r in range(height):
            if r < len(column):
                _joint(grid[r, c], cell, column[r], motions)
            else:
                grid[r, c].set_visible(False)
        grid[len(column) - 1, c].tick_params(labelbottom=True)
        grid[len(column) - 1, c].set_xlabel(ALONG["point"])
    handles = grid[0, 0].get_lines()[: len(motions)]
    if len(motions) > 1:
        figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    if title:
        figure.suptitle(title, color=INK)
    return figure


def figure_steps(cell: Cell, motions: Sequence[Motion], *, title: str = "") -> Figure:
    """Compare the largest step of a revolute joint between neighbouring points [deg].

    Raises:
        ShapeError: A motion has other columns than the cell.
    """
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    ax = figure.add_subplot()
    turning = [k for k, joint in enumerate(cell.joints) if joint.kind == "revolute"]
    for k, motion in enumerate(motions):
        _check_columns(cell, motion)
        step = np.degrees(np.abs(np.diff(motion.q[:, turning], axis=0)).max(axis=1))
        ax.stairs(
            step, np.arange(1, len(step) + 2), lw=2, color=COLOURS[k % 7], ls=DASHES[k % 7],
            label=f"{motion.label} (largest {step.max():.1f}°)", baseline=None,
        )  # fmt: skip
    dress(ax, "point")
    ax.set_ylabel("largest joint step [deg]")
    ax.set_ylim(bottom=0)
    say(ax, title)
    ax.legend(frameon=False, fontsize=9)
    return figure


def _joint(ax: Axes, cell: Cell, k: int, motions: Sequence[Motion]) -> None:
    joint = cell.joints[k]
    turning = joint.kind == "revolute"
    scale = 180 / np.pi if turning else 1.0
    low, high = cell.lower[k] * scale, cell.upper[k] * scale
    for m, motion in enumerate(motions):
        x = np.arange(1, len(motion.q) + 1)
        ax.plot(
            x, motion.q[:, k] * scale, lw=1.5, color=COLOURS[m % 7], ls=DASHES[m % 7],
            label=motion.label,
        )  # fmt: skip
    for bound in (low, high):
        ax.axhline(bound, color=INK, lw=0.8)
    room = 0.08 * (high - low)
    ax.set_ylim(min(low, ax.get_ylim()[0]) - room, max(high, ax.get_ylim()[1]) + room)
    # Outside the bounds the ground is grey: a curve that leaves them is seen at once.
    ax.axhspan(ax.get_ylim()[0], low, color=FAINT, alpha=0.5, lw=0)
    ax.axhspan(high, ax.get_ylim()[1], color=FAINT, alpha=0.5, lw=0)
    dress(ax)
    ax.set_yticks([low, *([0.0] if low < 0 < high else []), high])
    ax.yaxis.set_major_formatter("{x:.4g}")
    ax.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    ax.tick_params(labelsize=7)
    ax.set_title(
        f"{joint.name} [{'deg' if turning else 'm'}]", fontsize=8, color=INK, loc="left", pad=2
    )


def _check_columns(cell: Cell, motion: Motion) -> None:
    if np.ndim(motion.q) != 2 or motion.q.shape[1] != cell.n:
        raise ShapeError(
            f"(h, {cell.n}) is expected for {motion.label!r}; given {np.shape(motion.q)}",
            field="q",
        )

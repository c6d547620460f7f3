"""Joint motions within their bounds, and their steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.cell import Cell
from dualarm_pin.errors import ShapeError
from dualarm_pin.show.plots.style import ALONG, COLOURS, DASHES, FAINT, INK, dress, finish, plot


def figure_joints(cell: Cell, answers: Mapping[str, Trajectory], *, title: str = "") -> Figure:
    """Draw every joint within its bounds, one small plot per joint, one column per arm.

    Angles are in degrees, prismatic joints in metres.

    Raises:
        ShapeError: An answer has other columns than the cell.
    """
    _check_columns(cell, answers)
    owners = ("arm1", "arm2", "common")
    columns = [[k for k, j in enumerate(cell.joints) if j.arm == arm] for arm in owners]
    columns = [column for column in columns if column]
    height = max(map(len, columns))
    figure = Figure(figsize=(3.6 * len(columns), 1.05 * height + 1.0), layout="constrained")
    grid = figure.subplots(height, len(columns), squeeze=False, sharex=True)
    for c, column in enumerate(columns):
        for r in range(height):
            if r < len(column):
                _joint(grid[r, c], cell, column[r], answers)
            else:
                grid[r, c].set_visible(False)
        grid[len(column) - 1, c].tick_params(labelbottom=True)
        grid[len(column) - 1, c].set_xlabel(ALONG["point"])
    handles = grid[0, 0].get_lines()[: len(answers)]
    if len(answers) > 1:
        figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    if title:
        figure.suptitle(title, color=INK)
    return figure


def figure_steps(cell: Cell, answers: Mapping[str, Trajectory], *, title: str = "") -> Figure:
    """Compare the largest step of a revolute joint between neighbouring points [deg].

    Raises:
        ShapeError: An answer has other columns than the cell.
    """
    _check_columns(cell, answers)
    figure, ax = plot(3.6)
    turning = [k for k, joint in enumerate(cell.joints) if joint.kind == "revolute"]
    for k, (label, answer) in enumerate(answers.items()):
        step = np.degrees(np.abs(np.diff(answer.q[:, turning], axis=0)).max(axis=1))
        ax.stairs(
            step, np.arange(1, len(step) + 2), lw=2, color=COLOURS[k % 7], ls=DASHES[k % 7],
            label=f"{label} (largest {step.max():.1f}°)", baseline=None,
        )  # fmt: skip
    finish(ax, title, "largest joint step [deg]", "point")
    ax.set_ylim(bottom=0)
    return figure


def _joint(ax: Axes, cell: Cell, k: int, answers: Mapping[str, Trajectory]) -> None:
    joint = cell.joints[k]
    turning = joint.kind == "revolute"
    scale = 180 / np.pi if turning else 1.0
    low, high = cell.lower[k] * scale, cell.upper[k] * scale
    for m, (label, answer) in enumerate(answers.items()):
        x = np.arange(1, len(answer.q) + 1)
        ax.plot(
            x, answer.q[:, k] * scale, lw=1.5, color=COLOURS[m % 7], ls=DASHES[m % 7],
            label=label,
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


def _check_columns(cell: Cell, answers: Mapping[str, Trajectory]) -> None:
    for label, answer in answers.items():
        if answer.q.shape[1] != cell.n:
            raise ShapeError(
                f"(h, {cell.n}) is expected for {label!r}; given {answer.q.shape}", field="q"
            )

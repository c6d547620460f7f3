"""The relative path as a figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from matplotlib.figure import Figure

from dualarm_pin.path import Path
from dualarm_pin.show.plots.style import COLOURS, INK, dress, say


def figure_path(path: Path, Gamma: Sequence[int] | None = None, *, title: str = "") -> Figure:
    """Draw the relative path as e1 sees it (Fig. 3).

    A path in a coordinate plane is drawn flat, any other in three dimensions.

    Args:
        path: The path, h points.
        Gamma: Points of the first stage, counted from 0 as everywhere in the package; the figure
            counts them from 1, as the paper does.
        title: Title of the figure.
    """
    x = path.position
    extent = np.ptp(x, axis=0)
    flat = [k for k in range(3) if extent[k] <= 0.01 * extent.max()]
    axes = [k for k in range(3) if k != flat[-1]] if flat else [0, 1, 2]
    names = [f"${'xyz'[k]}_{{e_1}}$ [m]" for k in axes]
    figure = Figure(figsize=(5.2, 4.6), layout="constrained")
    ax = figure.add_subplot(projection=None if flat else "3d")
    points = x[:, axes]
    ax.plot(*points.T, color=COLOURS[0], lw=1.6, marker="o", ms=3.5, label=f"{path.h} points")
    ax.plot(*points[:1].T, "o", ms=9, mfc="none", color=INK, label="first point", ls="none")
    if Gamma is not None:
        chosen = points[np.asarray(Gamma)]
        ax.plot(*chosen.T, "D", ms=8, mfc="none", mew=1.6, color=COLOURS[1], label=r"$\Gamma$")
        if flat:
            for number, place in zip(Gamma, chosen, strict=True):
                ax.annotate(
                    str(number + 1), place, (7, 7), textcoords="offset points", color=COLOURS[1]
                )
    ax.set_xlabel(names[0])
    ax.set_ylabel(names[1])
    if not flat:
        spatial = cast(Any, ax)  # the three-dimensional axes of matplotlib have no types
        spatial.set_zlabel(names[2])
        spatial.set_box_aspect(np.maximum(extent, 0.05 * extent.max()))
    else:
        ax.set_aspect("equal", adjustable="datalim")
        ax.margins(0.16)
        dress(ax)
    say(ax, title, f"${'xyz'[flat[-1]]}_{{e_1}}$ = {x[0, flat[-1]]:.3g} m" if flat else "")
    ax.legend(frameon=False, fontsize=9)
    return figure

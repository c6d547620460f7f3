"""One look for all figures, and how they are written."""

from __future__ import annotations

import pathlib
from typing import Final

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#4D4D4D")
"""Okabe and Ito: told apart by all common kinds of colour vision. Dashes and marks differ too."""
DASHES: Final[tuple[tuple[int, tuple[float, ...]], ...]] = (
    (0, ()), (0, (6, 2)), (0, (2, 1.5)), (0, (7, 2, 1.5, 2)), (0, (4, 1, 1, 1, 1, 1)),
    (0, (10, 3)), (0, (1, 1)),
)  # fmt: skip
INK, FAINT = "#22262b", "#c9ced6"
ALONG = {"point": "path point", "arc_length": "arc length [m]"}


def dress(ax: Axes, along: str | None = None) -> None:
    """Give `ax` the common look, and the horizontal axis `along` if named."""
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(INK)
    ax.tick_params(colors=INK)
    ax.grid(True, color=FAINT, lw=0.6, alpha=0.7)
    ax.set_axisbelow(True)
    if along is not None:
        ax.set_xlabel(ALONG[along])
        ax.margins(x=0.01)
        if along == "point":
            ax.xaxis.set_major_locator(MaxNLocator(integer=True, steps=[1, 2, 3, 5, 6, 10]))


def plot(height: float) -> tuple[Figure, Axes]:
    """Return an empty figure of this height [inch] with one pair of axes."""
    figure = Figure(figsize=(6.4, height), layout="constrained")
    return figure, figure.add_subplot()


def finish(ax: Axes, title: str, quantity: str, along: str) -> None:
    """Dress `ax`, whose curves are drawn, and say what it shows."""
    dress(ax, along)
    ax.set_ylabel(quantity)
    say(ax, title)
    ax.legend(frameon=False, fontsize=9, loc="best")


def say(ax: Axes, title: str, note: str = "") -> None:
    """Put a title on the left of `ax` and a note on its right."""
    if title:
        ax.set_title(title, loc="left", color=INK, fontsize=11)
    if note:
        ax.set_title(note, loc="right", color="#5b626b", fontsize=9)


def save(figure: Figure, file_stem: str | pathlib.Path) -> tuple[pathlib.Path, pathlib.Path]:
    """Write `file_stem` with `.svg` and `.png` added; the same figure gives the same bytes.

    Returns:
        The two files.
    """
    stem = pathlib.Path(file_stem)
    stem.parent.mkdir(parents=True, exist_ok=True)
    svg, png = stem.with_name(stem.name + ".svg"), stem.with_name(stem.name + ".png")
    with rc_context({"svg.hashsalt": "dualarm_pin"}):
        figure.savefig(svg, metadata={"Date": None, "Creator": None})
    figure.savefig(png, dpi=160, metadata={"Software": None})
    return svg, png

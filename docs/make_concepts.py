"""Draw the pictures of the concepts: `python docs/make_concepts.py`.

Two are drawings, one counts where random starts of the paper's task end, three show the results of
the gallery.
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

import dualarm_pin as dp
from dualarm_pin.motion.record import Motion
from dualarm_pin.search.whole_path import WholePathLaw
from dualarm_pin.show.plots.style import COLOURS, dress, save

HERE = Path(__file__).resolve().parent
RESULTS, ASSETS = HERE / "results", HERE / "manual" / "assets"
STARTS = 300  # of the evidence
BLUE, ORANGE, GREEN, *_ = COLOURS
GREY = "0.45"


def main() -> None:
    """Draw all."""
    for name, draw in {
        "relative": relative,
        "index": index,
        "whole_path": whole_path,
        "evidence": evidence,
        "clearance": clearance,
        "motion": motion,
    }.items():
        figure = Figure(figsize=(7.0, 3.2), layout="constrained")
        draw(figure.subplots())
        file, picture = save(figure, ASSETS / name)
        picture.unlink()
        print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")


def relative(ax: Axes) -> None:
    """Draw two arms in the plane, their frames, and the pose between the tools."""
    arms = {1: [(0, 0), (0.2, 0.9), (1.1, 1.1), (1.5, 0.75)]}
    arms[2] = [(3.4, 0), (3.3, 1.0), (2.5, 1.35), (2.05, 1.0)]
    for arm, colour in ((1, BLUE), (2, ORANGE)):
        x, y = np.array(arms[arm]).T
        ax.plot(x, y, "-", color=colour, lw=6, solid_capstyle="round", alpha=0.35)
        ax.plot(x[:-1], y[:-1], "o", color=colour, ms=9)
        ax.annotate(f"b{arm}", (x[0], y[0]), (0, -18), textcoords="offset points", ha="center")
        ax.annotate(f"arm{arm}: $q_{arm}$", (x[1], y[1]), (-12, 8), textcoords="offset points",
                    ha="right" if arm == 1 else "left", color=colour)  # fmt: skip
    for (x, y), angle, name in (((1.5, 0.75), -40, "e1"), ((2.05, 1.0), 215, "e2")):
        for turn in (0, 90):
            way = 0.22 * np.array(
                [np.cos(np.radians(angle + turn)), np.sin(np.radians(angle + turn))]
            )
            ax.annotate(
                "", (x + way[0], y + way[1]), (x, y), arrowprops={"arrowstyle": "->", "lw": 1.6}
            )
        ax.annotate(name, (x, y), (0, -20), textcoords="offset points", ha="center", weight="bold")
    _arrow(ax, (1.5, 0.75), (2.05, 1.0), "$T_{e1 e2}$", 0.10, GREEN)
    _arrow(ax, (0, 0), (3.4, 0), "$T_{b1 b2}$", -0.14, GREY)
    ax.set(xlim=(-0.6, 4.2), ylim=(-0.35, 1.6), aspect="equal")
    ax.axis("off")


def _arrow(
    ax: Axes,
    tail: tuple[float, float],
    head: tuple[float, float],
    text: str,
    up: float,
    colour: str,
) -> None:
    ax.annotate("", head, tail, arrowprops={"arrowstyle": "->", "color": colour, "lw": 2})
    middle = np.mean([tail, head], axis=0)
    ax.text(middle[0], middle[1] + up, text, color=colour, ha="center", va="center", fontsize=12)


def index(ax: Axes) -> None:
    """Draw the ellipse of the forces of torque 1, a direction, and its length."""
    A = np.array([[0.55, 0.35], [0.35, 1.1]])  # m^2; the first two rows of some posture
    share, axes = np.linalg.eigh(A)
    turn = float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0])))
    ax.add_patch(Ellipse((0, 0), 2 / share[0] ** 0.5, 2 / share[1] ** 0.5, angle=turn, fc=BLUE,
                         alpha=0.2, ec=BLUE))  # fmt: skip
    for degrees, colour in ((150.0, GREEN), (40.0, ORANGE)):
        u = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        c = float(u @ A @ u)
        head = u / c**0.5
        ax.annotate("", head, (0, 0), arrowprops={"arrowstyle": "->", "color": colour, "lw": 2})
        ax.annotate(f"$c = {c:.2f}$ m², length {c**-0.5:.2f}", head, (8 * np.sign(u[0]), 4),
                    textcoords="offset points", ha="left" if u[0] > 0 else "right",
                    color=colour)  # fmt: skip
    ax.set(xlim=(-3.2, 3.2), ylim=(-1.45, 1.45), aspect="equal")
    ax.axis("off")


def whole_path(ax: Axes) -> None:
    """Draw the index along the path, step by step and at once."""
    for name, label, colour in (
        ("step_by_step", "step by step", ORANGE),
        ("at_once", "the whole path at once", BLUE),
    ):
        _, answer = dp.load_result(RESULTS / "corner" / name)
        points = np.arange(1, len(answer.index) + 1)
        label = f"{label} (mean {answer.mean_index:.2f})"
        ax.plot(points, answer.index, "-o", ms=3, color=colour, label=label)
    _finish(ax, "point", "index $c$ [m²], lower is better")


def evidence(ax: Axes) -> None:
    """Count the objectives in which random starts of the paper's task end."""
    task = dp.Task.load(dp.urdf_folder() / "tasks" / "paper_corner.yaml")
    _, best = dp.load_result(RESULTS / "corner" / "at_once")
    law = WholePathLaw(task.problem(), seed=0)
    law.grow(STARTS)
    ends = law.drawn().ends  # type: ignore[union-attr]
    objectives = ends.objective[ends.converged]
    ax.hist(objectives, bins=40, color=BLUE, alpha=0.7)
    ax.axvline(best.objective, color=ORANGE, lw=2)
    ax.annotate(f"best known {best.objective:.2f}", (best.objective, ax.get_ylim()[1]), (6, -12),
                textcoords="offset points", color=ORANGE)  # fmt: skip
    text = f"objective; {len(objectives)} of {STARTS} random starts ended in a minimum"
    _finish(ax, text, "starts", legend=False)


def clearance(ax: Axes) -> None:
    """Draw the smallest distance at the points and between them."""
    _, answer = dp.load_result(RESULTS / "table")
    at, between = answer.checked.clearance, answer.checked.apart.between
    h = len(at.distance)
    ax.plot(np.arange(1, h + 1), at.distance, "o", color=BLUE, ms=4, label="at the points")
    ax.stairs(
        between, np.arange(1, h + 1), color=ORANGE, baseline=None, label="on the way to the next"
    )
    ax.axhline(0.02, color=GREY, ls="--", label="asked for")
    ax.set_ylim(bottom=0.0)
    _finish(ax, "point", "smallest distance [m]")


def motion(ax: Axes) -> None:
    """Draw speed and acceleration of the nearest joint as shares of the limits."""
    task, _ = dp.load_result(RESULTS / "curve")
    made = Motion.load(RESULTS / "curve")
    joints = task.cell.joints
    speed = np.max(np.abs(made.velocity) / [j.velocity for j in joints], axis=1)
    rate = np.max(np.abs(made.acceleration) / [j.acceleration for j in joints], axis=1)
    ax.plot(made.time, 100 * speed, color=BLUE, label="speed")
    ax.plot(made.time, 100 * rate, color=ORANGE, label="acceleration")
    ax.axhline(100, color=GREY, ls="--", label="limit")
    ax.set_ylim(0, 125)
    _finish(ax, "time [s]", "nearest joint [% of its limit]")


def _finish(ax: Axes, x: str, y: str, *, legend: bool = True) -> None:
    dress(ax)
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    if legend:
        ax.legend(frameon=False, fontsize=9)


if __name__ == "__main__":
    main()

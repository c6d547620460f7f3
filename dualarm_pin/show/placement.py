"""A placement as files: the cell and task found, the motion, the map, the list of places."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ruamel.yaml import YAML

from dualarm_pin.answer.folder import save_result
from dualarm_pin.files.write import write_bytes, write_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from dualarm_pin.answer.trajectory import Trajectory
    from dualarm_pin.planners.placement import Placement
    from dualarm_pin.planners.placement_map import PlaceMap
    from dualarm_pin.task import Task


def save_placement(folder: str | Path, found: Placement, maps: tuple[PlaceMap, ...] = ()) -> None:
    """Write a result folder with `cell.yaml`, `places.csv`, and `map.npz`, `.png`, `.svg`.

    Raises:
        InputError: The folder cannot be written.
    """
    folder = Path(folder)
    write_text(folder / "places.csv", _places(found))
    if maps:
        from dualarm_pin.show.plots.style import save

        arrays: dict[str, Any] = {}
        for each in maps:
            name = "_".join(each.axes)
            for field in ("first", "second", "objective", "clearance", "kept_out", "best"):
                arrays[f"{name}_{field}"] = np.asarray(getattr(each, field))
        packed = io.BytesIO()
        np.savez(packed, **arrays)
        write_bytes(folder / "map.npz", packed.getvalue())
        save(figure_places(maps), folder / "map")
    save_with_cell(folder, found.task, found.trajectory)


def save_with_cell(folder: str | Path, task: Task, trajectory: Trajectory) -> None:
    """Write a result folder with `cell.yaml` beside it, if the task came from a file.

    Raises:
        InputError: The folder cannot be written.
    """
    if task.record is not None:
        text = io.StringIO()
        writer = YAML(typ="safe", pure=True)
        writer.default_flow_style = None
        writer.dump(dict(task.record["cell"]), text)
        write_text(Path(folder) / "cell.yaml", text.getvalue())
    save_result(folder, task, trajectory)


def _places(found: Placement) -> str:
    text = io.StringIO()
    names = list(found.places[0].change) if found.places else []
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["objective", "hits", *names])
    for place in found.places:
        writer.writerow([place.objective, place.hits, *place.change.values()])
    return text.getvalue()


def figure_places(maps: tuple[PlaceMap, ...]) -> Figure:
    """Draw maps side by side; grey: not reached, hatched: the arms touch, dark: kept out."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.4 * len(maps), 4.4), layout="constrained")
    for ax, each in zip(np.ravel(figure.subplots(1, len(maps))), maps, strict=True):
        _draw(figure, ax, each)
    return figure


def _draw(figure: Figure, ax: Axes, each: PlaceMap) -> None:
    from dualarm_pin.show.plots.style import FAINT, INK, dress

    dress(ax)
    ax.grid(False)
    ax.set_facecolor(FAINT)
    shown = np.ma.masked_invalid(each.objective)
    top = float(np.nanpercentile(each.objective, 90)) if shown.count() else 1.0
    colours = ax.pcolormesh(
        each.first, each.second, shown, cmap="viridis_r", vmax=top, shading="nearest"
    )
    figure.colorbar(colours, ax=ax, label="objective", extend="max")
    levels = (-0.5, 0.5, 1.5)
    for mask, hatch in ((each.clearance <= 0.0, "///"), (each.kept_out, "xxx")):
        if mask.any():
            ax.contourf(
                each.first, each.second, mask.astype(float), levels,
                colors="none", hatches=["", hatch],
            )  # fmt: skip
    ax.plot(*each.best, "o", ms=9, mfc="none", mew=4, color="white")  # seen on dark places too
    ax.plot(*each.best, "o", ms=9, mfc="none", mew=2, color=INK, label="found")
    ax.set_xlabel(f"base 2 {each.axes[0]} [m]")
    ax.set_ylabel(f"base 2 {each.axes[1]} [m]")
    ax.set_title("grey: not reached, ///: arms touch, xxx: kept out", loc="left", fontsize=9)
    ax.legend(frameon=True, facecolor="white", framealpha=0.9, edgecolor="none", fontsize=9)

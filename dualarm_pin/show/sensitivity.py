"""The costs of a cell as text, as a file, and as rows of a report."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from dualarm_pin.files.write import write_text

if TYPE_CHECKING:
    from dualarm_pin.evidence.sensitivity import Costs

FILE = "sensitivity.json"
_HUNDREDTH = {"yaw": "mrad"}  # unit of an error of one thousandth; mm for every other parameter


def save_costs(folder: str | Path, costs: Costs) -> None:
    """Write `sensitivity.json` into a result folder.

    Raises:
        InputError: The folder cannot be written.
    """
    write_text(Path(folder) / FILE, json.dumps(asdict(costs), indent=1) + "\n")


def text_of(costs: Costs) -> str:
    """Return the costs as three tables of text."""
    sections = {
        "Errors of the cell": parameter_lines(costs),
        "Joint limits": limit_lines(costs),
        "Points with the largest index": point_lines(costs),
    }
    head = f"objective {costs.objective:.7g}"
    return "\n\n".join([head, *("\n".join([name, *lines]) for name, lines in sections.items())])


def parameter_lines(costs: Costs) -> list[str]:
    """Return a line for every parameter."""
    lines = []
    for cost in costs.parameters:
        unit = _HUNDREDTH.get(cost.name.rpartition(".")[2], "mm")
        line = (
            f"{cost.name:<14} 1 {unit}: joints kept {1e3 * cost.position_error:.3f} mm and "
            f"{1e3 * cost.rotation_error:.3f} mrad off; planned again the objective changes by "
            f"{1e-3 * cost.slope:+.3e}"
        )
        if cost.predicted is not None:
            line += f" to {cost.predicted:.7g}"
        if cost.solved is not None:
            line += f" (solved: {cost.solved:.7g})"
        lines.append(line)
    return lines


def limit_lines(costs: Costs) -> list[str]:
    """Return a line for every limit that holds."""
    lines = []
    for cost in costs.limits:
        line = (
            f"{cost.joint} {cost.side}: {cost.slope:.4g} per rad or m, holds at {cost.points} "
            f"points; 10 deg (0.1 m) more would give about {cost.predicted:.5g}"
        )
        if cost.solved is not None:
            line += f" (solved: {cost.solved:.5g})"
        lines.append(line)
    return lines or ["none costs anything"]


def point_lines(costs: Costs) -> list[str]:
    """Return a line for every point named."""
    return [
        f"point {cost.point}: index {cost.index:.4g}, {100 * cost.share:.1f} % of the sum"
        + (f"; at a limit: {', '.join(cost.limits)}" if cost.limits else "")
        for cost in costs.points
    ]

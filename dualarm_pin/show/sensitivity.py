"""The costs of a cell as text, as a file, and as rows of a report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from dualarm_pin.errors import InputError
from dualarm_pin.evidence.sensitivity import Costs
from dualarm_pin.files.write import write_text

FILE = "sensitivity.json"
_THOUSANDTH = {"yaw": "mrad"}  # unit of an error of one thousandth; mm for every other parameter


def save_costs(folder: str | Path, costs: Costs) -> None:
    """Write `sensitivity.json` into a result folder.

    Raises:
        InputError: The folder cannot be written.
    """
    write_text(Path(folder) / FILE, json.dumps(asdict(costs), indent=1) + "\n")


def load_costs(folder: str | Path) -> Costs | None:
    """Read `sensitivity.json` of a result folder, or return None where there is none.

    Raises:
        InputError: It is not what `save_costs` wrote.
    """
    file = Path(folder) / FILE
    if not file.is_file():
        return None
    try:
        return TypeAdapter(Costs).validate_json(file.read_bytes())
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(map(str, first["loc"])) or None
        message = f"not written by this program: {first['msg']}; delete it"
        raise InputError(message, file=file, field=field) from error


def rows_of(costs: Sequence[Costs | None]) -> list[tuple[str, list[str]]]:
    """Return rows of text for a report: one column for each result, empty where there are none."""
    makers = {
        "errors of the cell": lambda each: [
            *filter(None, [elsewhere(each)]),
            *parameter_lines(each),
        ],
        "joint limits": limit_lines,
        "largest index": point_lines,
    }
    return [
        (name, ["" if each is None else "\n".join(lines(each)) for each in costs])
        for name, lines in makers.items()
    ]


def text_of(costs: Costs) -> str:
    """Return the costs as three tables of text."""
    sections = {
        "Errors of the cell": parameter_lines(costs),
        "Joint limits": limit_lines(costs),
        "Points with the largest index": point_lines(costs),
    }
    head = f"objective {costs.objective:.7g}" + ("; " if costs.elsewhere else "") + elsewhere(costs)
    return "\n\n".join([head, *("\n".join([name, *lines]) for name, lines in sections.items())])


def elsewhere(costs: Costs) -> str:
    """Return what to know where the motion is not at the minimum of these figures, else nothing."""
    if not costs.elsewhere:
        return ""
    held = ", held there by the distances asked for" if costs.clearance else ""
    left = "without distances" if costs.clearance else "near it"
    return f"the motion itself has {costs.given:.7g}{held}: all figures are of the minimum {left}"


def parameter_lines(costs: Costs) -> list[str]:
    """Return a line for every parameter."""
    lines = []
    for cost in costs.parameters:
        unit = _THOUSANDTH.get(cost.name.rpartition(".")[2], "mm")
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
        points = f"{cost.points} point{'' if cost.points == 1 else 's'}"
        line = (
            f"{cost.joint} {cost.side}: {cost.slope:.4g} per rad or m, holds at {points}; "
            f"10 deg (0.1 m) more would give about {cost.predicted:.5g}"
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

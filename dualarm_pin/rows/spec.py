"""What the `constraints:` section of a task file may hold: a list, one entry of `ROWS` each.

    constraints:
      - {above: {frame: arm1/tip, z: 0.6}}
      - {half_space: {frame: arm2/tip, normal: [0, 1, 0], offset: 0.2}, points: [1, 2, 3]}
      - {inside: {frame: arm2/tip, box: {x: [0.7, 0.8], z: [0.6, null]}}}
      - {axis_within: {frame: arm2/tip, axis: [0, 0, 1], of: [0, 0, -1], deg: 30}}
      - {joint_range: {joint: arm1/joint_5, deg: [-80, 80]}, points: [1, 13]}
      - {call: "my_rows:near", radius: 0.2}

`points` count from 1 and say where the row holds; without them it holds everywhere. `call` names a
function of the user's own that returns a `Row` (see `files.call`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field, model_validator

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError
from dualarm_pin.files.call import OwnFunction
from dualarm_pin.files.numbers import Point
from dualarm_pin.files.one_of import OneOf, one_of
from dualarm_pin.rows.angles import axis_within, joint_range
from dualarm_pin.rows.half_space import above, below, half_space, inside
from dualarm_pin.rows.row import Row
from dualarm_pin.rows.table import row_table

ROWS: Mapping[str, Callable[..., Row | tuple[Row, ...]]] = {
    "above": above,
    "below": below,
    "half_space": half_space,
    "inside": inside,
    "axis_within": axis_within,
    "joint_range": joint_range,
}
Points = Annotated[list[Point], Field(min_length=1)]


@one_of(ROWS, without=("points", "name", "cell"))
class RowSpec(OneOf):
    """One entry of `constraints:`: a kind of row, and where it holds.

    Attributes:
        call: A function of your own that returns a `Row`; its arguments stand beside it, such as
            `my_rows:near`.
        points: Points of the path, from 1, at which it holds; all by default, such as `[1, 2, 31]`.
    """

    noun = "row"

    points: Points | None = None

    @model_validator(mode="before")
    @classmethod
    def _points_beside(cls, data: Any) -> Any:
        """Read `points` among the arguments of a row as standing beside it."""
        if isinstance(data, dict) and "points" not in data:
            for kind in cls.table.keys() & data.keys():
                if isinstance(data[kind], dict) and "points" in data[kind]:
                    inner = {key: v for key, v in data[kind].items() if key != "points"}
                    return data | {kind: inner, "points": data[kind]["points"]}
        return data


def load_rows(
    specs: Sequence[RowSpec], own: Sequence[OwnFunction | None], cell: Cell, h: int
) -> tuple[Row, ...]:
    """Return the rows that a task file asks for, checked against its cell and its h points.

    Args:
        specs: The checked entries.
        own: For each the function of the user's own that it calls, or None.
        cell: The two arms.
        h: Points of the path.

    Raises:
        InputError: A row is wrong, or does not fit the cell or the path; the field says which.
        UnknownNameError: The cell has no such frame.
    """
    rows: list[Row] = []
    for number, (spec, function) in enumerate(zip(specs, own, strict=True)):
        try:
            made = spec.make(cell=cell) if function is None else function.result(Row)
            for row in made if isinstance(made, tuple) else (made,):
                if spec.points is not None:
                    row = replace(row, points=tuple(point - 1 for point in spec.points))
                row_table([row], cell, h, equality=row.equality)
                rows.append(row)
        except InputError as error:
            if error.file is not None:
                raise
            place = ["constraints", str(number), *spec.place]
            # A field that is an argument is at fault; any other names the row itself.
            place += [error.field] if error.field in type(spec.given).model_fields else []
            raise type(error)(error.message, field=".".join(place)) from error
    return tuple(rows)

"""What the `constraints:` section of a task file may hold: a list, one row of `ROWS` each.

    constraints:
      - {above: {frame: arm1/tip, z: 0.6}}
      - {half_space: {frame: arm2/tip, normal: [0, 1, 0], offset: 0.2}, points: [1, 2, 3]}
      - {call: "my_rows:near", radius: 0.2}

`points` count from 1 and say where the row holds; without them it holds everywhere. `call` names a
function of the user's own that returns a `Row` (see `files.call`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated

from pydantic import Field

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError
from dualarm_pin.files.call import OwnFunction
from dualarm_pin.files.numbers import Point
from dualarm_pin.files.one_of import OneOf, one_of
from dualarm_pin.rows.half_space import above, below, half_space
from dualarm_pin.rows.row import Row
from dualarm_pin.rows.table import row_table

ROWS: Mapping[str, Callable[..., Row]] = {"above": above, "below": below, "half_space": half_space}
Points = Annotated[list[Point], Field(min_length=1)]


@one_of(ROWS, without=("points", "name"))
class RowSpec(OneOf):
    """One entry: a kind of row, and where it holds."""

    noun = "row"

    points: Points | None = None


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
    rows = []
    for number, (spec, function) in enumerate(zip(specs, own, strict=True)):
        try:
            row: Row = spec.make() if function is None else function.result(Row)
            if spec.points is not None:
                row = replace(row, points=tuple(point - 1 for point in spec.points))
            row_table([row], cell, h, equality=row.equality)
        except InputError as error:
            if error.file is not None:
                raise
            place = ["constraints", str(number), *spec.place]
            # A field that is an argument is at fault; any other names the row itself.
            place += [error.field] if error.field in type(spec.given).model_fields else []
            raise type(error)(error.message, field=".".join(place)) from error
        rows.append(row)
    return tuple(rows)

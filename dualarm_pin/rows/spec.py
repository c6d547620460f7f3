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
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, create_model, model_validator

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError
from dualarm_pin.files.call import CallSpec, call_apart, own_function
from dualarm_pin.files.signature import spec_of
from dualarm_pin.files.source import Source, Spec
from dualarm_pin.rows.half_space import above, below, half_space
from dualarm_pin.rows.row import Row
from dualarm_pin.rows.table import row_table

ROWS: Mapping[str, Callable[..., Row]] = {"above": above, "below": below, "half_space": half_space}
Points = list[Annotated[int, Field(ge=1)]]


class _OneRow(Spec):
    """One entry without its kinds: exactly one of them is given."""

    call: CallSpec | None = None
    points: Points | None = None

    @model_validator(mode="before")
    @classmethod
    def _call_apart(cls, data: Any) -> Any:
        return call_apart(data, ("points",))

    @model_validator(mode="after")
    def _exactly_one(self) -> _OneRow:
        if len(self.given) != 1:
            shown = ", ".join(self.given) or "none"
            raise ValueError(f"exactly one of {', '.join(ROWS)} or call is expected; given {shown}")
        return self

    @property
    def given(self) -> list[str]:
        """Kinds of rows that the entry gives, or `call`."""
        return [name for name in (*ROWS, "call") if getattr(self, name) is not None]


if TYPE_CHECKING:
    RowSpec = _OneRow
else:
    RowSpec = create_model(
        "RowSpec",
        __base__=_OneRow,
        **{
            name: (spec_of(row, without=("points", "name")) | None, None)
            for name, row in ROWS.items()
        },
    )


def load_rows(specs: Sequence[RowSpec], source: Source, cell: Cell, h: int) -> tuple[Row, ...]:
    """Return the rows that a task file asks for, checked against its cell and its h points.

    Raises:
        InputError: A row is wrong, or does not fit the cell or the path; the field says which.
        UnknownNameError: The cell has no such frame.
    """
    rows = []
    for number, spec in enumerate(specs):
        kind = spec.given[0]
        place = f"constraints.{number}" + ("" if kind == "call" else f".{kind}")
        try:
            if kind == "call":
                arguments = getattr(spec, kind).arguments
                row = own_function(source, ("constraints", number), arguments).result(Row)
            else:
                row = ROWS[kind](**getattr(spec, kind).arguments)
            if spec.points is not None:
                row = replace(row, points=tuple(point - 1 for point in spec.points))
            row_table([row], cell, h, equality=row.equality)
        except InputError as error:
            if error.file is not None:
                raise
            # A field of a row is an argument of it; any other names the row itself.
            of_row = error.field if error.field in ("normal", "offset", "point", "z") else None
            field = f"{place}.{of_row}" if of_row else place
            raise type(error)(error.message, field=field) from error
        rows.append(row)
    return tuple(rows)

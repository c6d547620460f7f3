"""What the `index:` section of a task file may hold.

One index of `indices.INDICES` with its arguments, or `call` with those of a function of the user's
own (see `files.call`), and what goes with any of them:

    index: {force: {direction: tangent, joint_weights: [1, 1, 1, 2, 2, 2]}, joint_centre: 0.1}
    index: {call: "my_index:along", weight: 2, direction: tangent}
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

from pydantic import model_validator

from dualarm_pin.files.call import CallSpec, OwnFunction
from dualarm_pin.files.numbers import Number, Vector, Weight
from dualarm_pin.files.one_of import OneOf, one_of
from dualarm_pin.files.signature import ArgumentsSpec
from dualarm_pin.indices import INDICES, Index

Six = tuple[Weight, Weight, Weight, Weight, Weight, Weight]
Direction = (
    Literal["tangent", "path"] | Vector | tuple[Number, Number, Number, Number, Number, Number]
)


class _Weighted(ArgumentsSpec):
    """What every index of ours takes.

    Attributes:
        task_weights: Weights of the six rows of the task (x, y, z, and turns about them), such as
            `[1, 1, 1, 2, 2, 2]`.
        joint_weights: A weight for each joint, such as `[1, 1, 1, 2, 2, 2]`.
        direction: Direction u in axes of e1: `tangent` of the path, `path` for that of a file of
            points, or a vector, such as `tangent`.
    """

    beside = ("direction",)

    task_weights: Six | None = None
    joint_weights: list[Weight] | None = None
    direction: Direction = "path"


class _OwnIndex(CallSpec):
    """A function of the user's own that returns an `Index`.

    Attributes:
        call: Module and function, with its arguments beside it, such as `my_index:along`.
        direction: As for our own indices, such as `tangent`.
    """

    direction: Direction = "path"


@one_of(INDICES, _Weighted)
class IndexSpec(OneOf):
    """The `index:` section: what is minimised at each point of the path.

    Attributes:
        call: A function of your own that returns an `Index`; its arguments stand beside it, such as
            `my_index:along`.
        joint_centre: Weight of the squared distances of the joints from the middle of their bounds,
            such as `0.1`.
    """

    noun = "index"
    short = ({"enum": list(INDICES)},)

    call: _OwnIndex | None = None
    joint_centre: Weight = 0.0

    @model_validator(mode="before")
    @classmethod
    def _bare_key(cls, data: Any) -> Any:
        """Read `force`, and `force:` without arguments, as `force: {}`."""
        if isinstance(data, str):
            return {data: {}}
        if isinstance(data, dict):
            return {k: {} if v is None and k in INDICES else v for k, v in data.items()}
        return data

    @property
    def direction(self) -> Direction:
        """The direction that is asked for; `path` leaves that of the path."""
        given: Any = self.given  # each kind has one
        direction: Direction = given.direction
        return direction


def load_index(spec: IndexSpec, own: OwnFunction | None = None) -> Index:
    """Return the index that a task file asks for.

    Args:
        spec: The checked section.
        own: The function of the user's own that the section calls, if it calls one.

    Raises:
        InputError: A function of the user's own is wrong.
    """
    index: Index = spec.make() if own is None else own.result(Index)
    return replace(index, joint_centre=spec.joint_centre or index.joint_centre)

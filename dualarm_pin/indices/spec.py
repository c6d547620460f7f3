"""What the `index:` section of a task file may hold.

One index of `indices.INDICES` with its arguments, or `call` with those of a function of the user's
own (see `files.call`), and what goes with any of them:

    index: {force: {direction: tangent, joint_weights: [1, 1, 1, 2, 2, 2]}, joint_centre: 0.1}
    index: {call: "my_index:along", weight: 2, direction: tangent}
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model, model_validator

from dualarm_pin.files.call import CallSpec, call_apart, own_function
from dualarm_pin.files.signature import ArgumentsSpec, spec_of
from dualarm_pin.files.source import Key, Source, Spec
from dualarm_pin.indices import INDICES, Index

Weight = Annotated[float, Field(ge=0.0)]
Six = tuple[Weight, Weight, Weight, Weight, Weight, Weight]
Direction = (
    Literal["tangent", "path"]
    | tuple[float, float, float]
    | tuple[float, float, float, float, float, float]
)


class _Weighted(ArgumentsSpec):
    """What every index of ours takes; `direction` is the path's tangent, or a vector in e1 axes."""

    beside = ("direction",)

    task_weights: Six | None = None
    joint_weights: list[Weight] | None = None
    direction: Direction = "path"


class _OwnIndex(CallSpec):
    """A function of the user's own that returns an `Index`; `direction` is as for ours."""

    direction: Direction = "path"


class _OneIndex(Spec):
    """The `index:` section without the indices: exactly one of them is given."""

    call: _OwnIndex | None = None
    joint_centre: Weight = 0.0

    @model_validator(mode="before")
    @classmethod
    def _bare_key(cls, data: Any) -> Any:
        """Read `force`, and `force:` without arguments, as `force: {}`."""
        if isinstance(data, str):
            return {data: {}}
        if isinstance(data, dict):
            data = {k: {} if v is None and k in INDICES else v for k, v in data.items()}
        return call_apart(data, ("joint_centre",))

    @model_validator(mode="after")
    def _exactly_one(self) -> _OneIndex:
        if len(self.given) != 1:
            raise ValueError(f"name exactly one of {', '.join(INDICES)}")
        return self

    @property
    def given(self) -> list[str]:
        """Names of the indices that the file gives, or `call`."""
        return [name for name in (*INDICES, "call") if getattr(self, name) is not None]

    @property
    def direction(self) -> Direction:
        """The direction that is asked for; `path` leaves that of the path."""
        direction: Direction = getattr(self, self.given[0]).direction
        return direction

    def place(self, key: str) -> tuple[str, ...]:
        """Return where an argument of the index stands in the section."""
        return (key,) if self.call is not None else (self.given[0], key)


if TYPE_CHECKING:
    IndexSpec = _OneIndex
else:
    IndexSpec = create_model(
        "IndexSpec",
        __base__=_OneIndex,
        **{
            name: (spec_of(factory, _Weighted, without=("joint_centre",)) | None, None)
            for name, factory in INDICES.items()
        },
    )


def load_index(spec: IndexSpec, source: Source, keys: tuple[Key, ...] = ("index",)) -> Index:
    """Return the index that a task file asks for.

    Raises:
        InputError: A function of the user's own is wrong.
    """
    name = spec.given[0]
    arguments = getattr(spec, name).arguments
    if name == "call":
        index = own_function(source, keys, arguments).result(Index)
    else:
        index = INDICES[name](**arguments)
    return replace(index, joint_centre=spec.joint_centre or index.joint_centre)

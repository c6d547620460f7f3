"""A section that names exactly one function: one of a table of ours, or `call` one's own.

    index: {force: {direction: tangent}, joint_centre: 0.1}
    index: {call: "my_index:along", weight: 2, joint_centre: 0.1}

What goes with any of the functions stands beside the name. The arguments of a function of ours
are checked by its signature, so adding one is an entry in its table.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Self, TypeVar, cast

from pydantic import GetJsonSchemaHandler, create_model, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from dualarm_pin.files.call import CallSpec
from dualarm_pin.files.signature import ArgumentsSpec, spec_of
from dualarm_pin.files.source import Spec


class OneOf(Spec):
    """The section without the functions of its table: `one_of` adds them.

    Attributes:
        noun: What the functions make, for messages.
        table: The functions by name.
        call: A function of the user's own, such as `my_module:my_function`.
    """

    noun: ClassVar[str]
    table: ClassVar[Mapping[str, Callable[..., Any]]]
    call: CallSpec | None = None

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the JSON schema: the functions of the table, or `call` and any argument."""
        schema = super().__get_pydantic_json_schema__(core, handler)
        ours = schema["anyOf"][0] if cls.short else schema
        said = ours["properties"].pop("call")
        call = {"type": "string", **{key: said[key] for key in ("description", "examples")}}
        beside = {k: v for k, v in ours["properties"].items() if k not in cls.table}
        own = {"type": "object", "properties": beside | {"call": call}, "required": ["call"]}
        return {"anyOf": [ours, own, *cls.short]}

    @property
    def kind(self) -> str:
        """Name of the one function that is given, or `call`."""
        return self._given()[0]

    @property
    def given(self) -> ArgumentsSpec | CallSpec:
        """What the file says about its arguments."""
        given: ArgumentsSpec | CallSpec = getattr(self, self.kind)
        return given

    @property
    def place(self) -> tuple[str, ...]:
        """Where its arguments stand in the section."""
        return () if self.call is not None else (self.kind,)

    def make(self, **more: Any) -> Any:
        """Call the function of the table with the arguments of the file.

        Args:
            more: Further arguments; it gets those that it takes.
        """
        function = self.table[self.kind]
        taken = inspect.signature(function).parameters.keys() & more.keys()
        return function(**self.given.arguments, **{name: more[name] for name in taken})

    def _given(self) -> list[str]:
        return [name for name in (*self.table, "call") if getattr(self, name) is not None]

    @model_validator(mode="before")
    @classmethod
    def _call_apart(cls, data: Any) -> Any:
        """Read `call` and its arguments, which stand beside it, as one section."""
        if not isinstance(data, dict) or "call" not in data:
            return data
        own = cls.model_fields.keys() - cls.table.keys() - {"call"}
        beside = {key: value for key, value in data.items() if key in own}
        return beside | {"call": {key: v for key, v in data.items() if key not in own}}

    @model_validator(mode="after")
    def _exactly_one(self) -> Self:
        given = self._given()
        if len(given) != 1:
            shown, known = ", ".join(given) or "none", ", ".join(self.table)
            raise ValueError(
                f"exactly one {self.noun} is expected; given {shown}; known: {known}, call"
            )
        return self


OneT = TypeVar("OneT", bound=OneOf)


def one_of(
    table: Mapping[str, Callable[..., Any]],
    beside: type[Spec] | None = None,
    without: tuple[str, ...] = (),
) -> Callable[[type[OneT]], type[OneT]]:
    """Give a section the functions of a table.

    Args:
        table: The functions by name.
        beside: Keys that stand among the arguments of each: see `spec_of`.
        without: Arguments that do not come from the section of the function.
    """

    def complete(section: type[OneT]) -> type[OneT]:
        section.table = table
        fields: dict[str, Any] = {
            name: (spec_of(function, beside, without, bounded=True) | None, None)
            for name, function in table.items()
        }
        made: Any = create_model(section.__name__, __base__=section, **fields)
        return cast(type[OneT], made)

    return complete

"""From the signature of a function to what a file may say about its arguments.

A key of the file is the name of an argument, `_deg` added where it is an angle; what is left out
has the default of the function. So adding such a function is writing it: its specification follows.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import (
    Annotated,
    Any,
    ClassVar,
    Self,
    Unpack,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

from pydantic import ConfigDict, Field, TypeAdapter, create_model, model_validator
from pydantic.errors import PydanticSchemaGenerationError, PydanticUserError

from dualarm_pin.files.numbers import MOST_POINTS, Number, Positive, Whole
from dualarm_pin.files.source import Spec

Count = Annotated[int, Field(ge=2, le=MOST_POINTS)]
_DEG = "_deg"
_NAMES_A_FILE = str | Path


@dataclass(frozen=True)
class InFile:
    """How a file gives an argument that Python takes more generously: `Annotated[X, InFile(Y)]`.

    Attributes:
        kind: The type that pydantic reads.
        degrees: The key ends in `_deg`; Python takes radians.
    """

    kind: Any
    degrees: bool = False


class ArgumentsSpec(Spec):
    """Keyword arguments of a function, as a file gives them."""

    beside: ClassVar[Collection[str]] = ()
    """Keys that stand among them and are none."""

    @property
    def arguments(self) -> dict[str, Any]:
        """What the file gives by the names of the arguments, angles in radians."""
        names = sorted(self.model_fields_set - set(self.beside))
        given = {name: getattr(self, name) for name in names}
        return {
            key.removesuffix(_DEG): math.radians(value) if key.endswith(_DEG) else value
            for key, value in given.items()
        } | dict(self.model_extra or {})


class _Sampled(ArgumentsSpec):
    """Where a curve gets its points: exactly one of the two.

    Attributes:
        points: Number of points, both ends included, such as `49`.
        step: Or the largest distance of neighbours along the curve [m], such as `0.005`.
    """

    points: Count | None = None
    step: Positive | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.points is None) == (self.step is None):
            given = "both are" if self.points is not None else "neither is"
            raise ValueError(f"give one of points and step: {given} given")
        return self


class _Resampled(ArgumentsSpec):
    """Points that are there already, or by default: at most one of `points` and `step`."""

    @model_validator(mode="after")
    def _not_both(self) -> Self:
        given = [getattr(self, key) for key in ("points", "step") if key in self.model_fields_set]
        if len(given) == 2 and None not in given:
            none = "" if type(self).model_fields["points"].default else ", or neither"
            raise ValueError(f"give points or step{none}: both are given")
        return self


class _Anything(ArgumentsSpec):
    """A function that takes any keyword."""

    model_config = ConfigDict(extra="allow")


class _NamesAFile(ArgumentsSpec):
    """Read `csv: FILE` as `csv: {file: FILE}`."""

    short = ({"type": "string"},)

    @model_validator(mode="before")
    @classmethod
    def _bare_name(cls, data: Any) -> Any:
        return {"file": data} if isinstance(data, str) else data


@lru_cache(maxsize=256)
def spec_of(
    function: Callable[..., Any],
    beside: type[Spec] | None = None,
    without: tuple[str, ...] = (),
    *,
    bounded: bool = False,
) -> type[ArgumentsSpec]:
    """Return the specification of a function's arguments.

    Args:
        function: Any function. `points` and `step`, its own or those of `**how: Unpack[...]`, are
            alternatives.
        beside: Keys that stand among the arguments and are checked as this says.
        without: Arguments that do not come from this place of the file.
        bounded: Plain numbers are lengths and the like, which have a largest value.
    """
    hints = _hints(function)
    fields: dict[str, Any] = {}
    bases: list[type[Spec]] = [ArgumentsSpec] if beside is None else [beside]
    without = (*without, *bases[0].model_fields)
    for parameter in inspect.signature(function).parameters.values():
        hint = hints.get(parameter.name, Any)
        if parameter.kind is parameter.VAR_KEYWORD:
            bases += _base_of_keywords(hint)
        elif parameter.kind is not parameter.VAR_POSITIONAL and parameter.name not in without:
            key, kind = _in_file(parameter.name, hint, bounded)
            fields[key] = (kind, ... if parameter.default is parameter.empty else parameter.default)
    if {"points", "step"} <= fields.keys():
        bases.append(_Resampled)
    if next(iter(fields), None) == "file":
        bases.append(_NamesAFile)
    made: Any = create_model(
        f"{function.__name__}Arguments",
        __base__=tuple(sorted(bases, key=lambda base: -len(base.__mro__))),
        __doc__=function.__doc__,
        **fields,
    )
    return cast(type[ArgumentsSpec], made)


def _hints(function: Callable[..., Any]) -> Mapping[str, Any]:
    target = function.__init__ if isinstance(function, type) else function  # type: ignore[misc]
    try:
        return get_type_hints(target, include_extras=True)
    except (NameError, TypeError):  # names for type checkers alone: take what the file gives
        return {}


def _base_of_keywords(hint: Any) -> Collection[type[ArgumentsSpec]]:
    """Return what `**how` stands for: exactly one of points and step, nothing, or anything."""
    if get_origin(hint) is not Unpack:
        return [_Anything]
    return [_Sampled] if "points" in get_type_hints(get_args(hint)[0]) else []


def _in_file(name: str, hint: Any, bounded: bool) -> tuple[str, Any]:
    """Return the key of an argument and the type that pydantic reads."""
    for extra in get_args(hint)[1:] if get_origin(hint) is Annotated else ():
        if isinstance(extra, InFile):
            return (name + _DEG if extra.degrees else name), extra.kind
    if name in ("points", "step"):
        return name, (Count if name == "points" else Positive) | None
    if hint == _NAMES_A_FILE:
        return name, str
    if bounded and hint in (int, float):
        return name, Number if hint is float else Whole
    try:
        TypeAdapter(hint)
    except (PydanticSchemaGenerationError, PydanticUserError):  # an array, or a class of theirs
        return name, Any
    return name, hint

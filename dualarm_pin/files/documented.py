"""What is said about every key of a file: from the docstring of its specification.

An entry of `Attributes:` (or `Args:` of a function whose arguments a file gives) holds the meaning,
the unit in brackets, and behind "such as" an example in backquotes. Without one the default is the
example, or what is said about the section that the key holds.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from ruamel.yaml import YAML

_SECTION = re.compile(r"^(?:Attributes|Args):\n((?:[ \t]+.*\n?|\n)*)", re.MULTILINE)
_ENTRY = re.compile(r"^    \**(\w+): (.*(?:\n {8,}.*)*)", re.MULTILINE)
_UNIT = re.compile(r"\[((?:rad|deg|m|mm|s|N|Hz|kg|rad or m)[^\]]*)\]")
_EXAMPLE = re.compile(r",?\s*such as `([^`]*)`")


@dataclass(frozen=True)
class Documented:
    """What is said about a key.

    Attributes:
        text: What it means, without the example.
        unit: Its unit, or None.
        example: A value that it may have; None if none is given.
    """

    text: str
    unit: str | None
    example: Any

    @classmethod
    def of(cls, entry: str) -> Documented:
        """Read an entry of a docstring."""
        entry = " ".join(entry.split())
        unit, example = _UNIT.search(entry), _EXAMPLE.search(entry)
        value = None if example is None else YAML(typ="safe", pure=True).load(example[1])
        text = _EXAMPLE.sub("", entry).strip()
        return cls(text, unit and unit[1], value)


def first_line(thing: type) -> str:
    """Return the first sentence of a docstring, empty without one."""
    text = inspect.cleandoc(vars(thing).get("__doc__") or "")
    return " ".join(text.split("\n\n")[0].split())


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """Return the specifications inside a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in get_args(annotation) for model in models_in(argument)]


@cache
def entries(text: str | None) -> Mapping[str, Documented]:
    """Return the entries of a docstring by name."""
    sections = _SECTION.findall(inspect.cleandoc(text or "") + "\n")
    found = (entry for section in sections for entry in _ENTRY.findall(section))
    return {name: Documented.of(entry) for name, entry in found}


@cache
def documented(model: type[BaseModel]) -> dict[str, Documented]:
    """Return what is said about each key of a specification; a key without a word is left out."""
    found: dict[str, Documented] = {}
    for name, field in model.model_fields.items():
        sections = models_in(field.annotation)
        said = next(_said(model, name), None)
        if said is None and sections:
            said = Documented(first_line(sections[0]), None, None)
        if said is None:
            continue
        example = said.example
        if example is None and not field.is_required():
            example = _plain(field.get_default(call_default_factory=True))
        if example is None and sections:
            example = example_of(sections[0])
            many = "list[" in str(field.annotation)
            example = [example] if many else example
        degrees = name.endswith("_deg") and name.removesuffix("_deg") in _words(model)
        if degrees and isinstance(example, int | float):
            example = round(math.degrees(example), 6)
        text = said.text.replace("[rad]", "[deg]") if degrees else said.text
        found[name] = Documented(text, "deg" if degrees else said.unit, example)
    return found


def example_of(model: type[BaseModel]) -> Any:
    """Return the smallest section that is valid and says something, or None."""
    known = {name: said.example for name, said in documented(model).items()}
    needed = {name for name, field in model.model_fields.items() if field.is_required()}
    least = {name: known.get(name) for name in model.model_fields if name in needed}
    spare = [
        {name: known[name]} for name in known if name not in needed and known[name] is not None
    ]
    nothing: list[dict[str, Any]] = [{}] if least else []
    for more in nothing + spare:
        try:
            model.model_validate(least | more)
        except ValidationError:
            continue
        return least | more
    return None


def _words(model: type[BaseModel]) -> dict[str, Documented]:
    """Return every entry of the docstrings of a specification, the nearest first."""
    found: dict[str, Documented] = {}
    for part in reversed(model.__mro__):
        found |= entries(vars(part).get("__doc__"))
    return found


def _said(model: type[BaseModel], name: str) -> Iterator[Documented]:
    words = _words(model)
    yield from (words[key] for key in (name, name.removesuffix("_deg")) if key in words)


def _plain(value: Any) -> Any:
    """Return a default as a file would give it; None for what says nothing."""
    if isinstance(value, BaseModel):
        value = value.model_dump(exclude_unset=True)
    if isinstance(value, tuple):
        value = [_plain(each) for each in value]
    return None if value in ([], {}, "") else value

"""Read YAML from users and check it, with the line of every mistake.

YAML 1.2 through ruamel.yaml: no code is run, duplicate keys are errors, and every key keeps its
line. What the text stands for is looked at before it is made: a small file of aliases of aliases
can stand for billions of values. Pydantic models then check names, types and ranges; all mistakes
are reported at once.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, NoReturn, TypeVar

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, ValidationError
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedBase, CommentedMap
from ruamel.yaml.constructor import RoundTripConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode

from dualarm_pin.errors import InputError, nearest
from dualarm_pin.files.documented import documented, first_line, models_in
from dualarm_pin.files.read import read_file

SpecT = TypeVar("SpecT", bound="Spec")
Key = str | int
_MOST_VALUES = 1_000_000  # aliases unfolded
DEEPEST = 50  # lists and mappings in each other; every one costs frames of Python's stack
_LARGEST = 1_000_000  # bytes: eight seconds of reading
_SURROGATE = re.compile("[\ud800-\udfff]")  # half a character: it cannot be written as UTF-8


@dataclass(frozen=True)
class Change:
    """A field set to another value, as `--set key=value` asks.

    Attributes:
        keys: Where.
        value: What is put there.
        text: What the user wrote.
    """

    keys: Sequence[Key]
    value: Any
    text: str

    def applied(self, data: Any) -> Any:
        """Return the data of a file with the field set, in mappings that are made where needed.

        What does not lead to the field is shared with `data`, which stays as it is.

        Raises:
            InputError: There is no such place.
        """
        field = f"--set {self.text}"
        node = data = _copied(data)
        for position, key in enumerate(self.keys[:-1], 1):
            try:
                if isinstance(node, dict) and not isinstance(node.get(key), dict | list):
                    node[key] = CommentedMap()
                node[key] = _copied(node[key])
                node = node[key]
            except (KeyError, IndexError, TypeError) as error:
                known = ".".join(map(str, self.keys[:position]))
                raise InputError(f"there is no {known} to set", field=field) from error
        try:
            node[self.keys[-1]] = self.value
        except (IndexError, TypeError) as error:
            raise InputError("there is no such place", field=field) from error
        return data


def _copied(node: Any) -> Any:
    """Return a list or mapping of a file with the same values and lines."""
    copied = type(node)(node)
    if isinstance(node, CommentedBase):
        node.copy_attributes(copied)
    return copied


class Spec(BaseModel):
    """Base of every specification: unknown keys are errors, values are strict and frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    short: ClassVar[Sequence[Mapping[str, Any]]] = ()
    """JSON schemas of what else a file may write for it."""

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the JSON schema, with what is said about each key and an example of it."""
        schema = handler.resolve_ref_schema(handler(core))
        schema["description"] = first_line(cls)
        for name, said in documented(cls).items():
            key: dict[str, Any] = schema["properties"][name]
            unit = f" [{said.unit}]" if said.unit and f"[{said.unit}" not in said.text else ""
            key["description"] = said.text + unit
            key["examples"] = [said.example]
        return {"anyOf": [schema, *cls.short]} if cls.short else schema


@dataclass(frozen=True)
class Source:
    """A YAML file as read: plain data, and where each key stands.

    Attributes:
        path: The file.
        data: What it holds; ruamel's round-trip containers, which remember their lines.
        changes: What was changed in it.
    """

    path: Path
    data: Any
    changes: tuple[Change, ...] = ()

    @cached_property
    def values(self) -> Any:
        """What it holds as plain Python values."""
        return plain(self.data)

    def changed(self, changes: Sequence[Change]) -> Source:
        """Return this file with other values at some places; it keeps its own."""
        data = self.data
        for change in changes:
            data = change.applied(data)
        return Source(self.path, data, (*self.changes, *changes))

    def line(self, keys: Sequence[Key]) -> int | None:
        """Return the line of the deepest part of `keys` that the file holds, from 1."""
        node, line = self.data, 1
        for key in keys:
            try:
                line = (
                    node.lc.key(key)[0] + 1 if hasattr(node, "keys") else node.lc.item(key)[0] + 1
                )
                node = node[key]
            except (AttributeError, KeyError, IndexError, TypeError):
                break
        return line

    def error(self, message: str, keys: Sequence[Key]) -> InputError:
        """Return an error that names this file, the line or the change of it, and the field."""
        field, line = ".".join(map(str, keys)), self.line(keys)
        for change in self.changes:
            if tuple(keys[: len(change.keys)]) == tuple(change.keys):
                field, line = f"--set {change.text}: {field}", None
        return InputError(message, file=self.path, line=line, field=field)

    @contextmanager
    def blamed(self) -> Iterator[None]:
        """Name this file and the line in an error that names a field and no file."""
        try:
            yield
        except InputError as error:
            if error.file is not None or error.field is None:
                raise
            keys = [int(key) if key.isdigit() else key for key in error.field.split(".")]
            raise self.error(error.message, keys) from error


def read_yaml(path: str | Path) -> Source:
    """Read one YAML file.

    Raises:
        MissingFileError: There is no such file, or it cannot be read.
        InputError: It is too large, not text, not YAML, or not a mapping.
    """
    path = Path(path)
    return parse_yaml(read_file(path, _LARGEST, "give the path of a YAML file"), path)


def parse_yaml(raw: bytes | str, path: str | Path) -> Source:
    """Parse YAML text that came from `path`.

    Raises:
        InputError: It is not text, not YAML, or not a mapping.
    """
    path = Path(path)
    try:
        text = raw if isinstance(raw, str) else raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        message = f"byte {error.start} is not UTF-8: save the file as UTF-8"
        raise InputError(message, file=path) from error
    try:
        data = yaml_of(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = None if mark is None else mark.line + 1
        reason = (error.problem or error.context or "not YAML").strip()
        raise InputError(f"not valid YAML: {reason}", file=path, line=line) from error
    except (YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"not valid YAML: {str(error).splitlines()[0]}", file=path) from error
    if not isinstance(data, dict):
        given = "an empty file" if data is None else f"a {type(data).__name__}"
        raise InputError(f"{given} where keys and values are expected", file=path, line=1)
    return Source(path, data)


def yaml_of(text: str) -> Any:
    """Return what YAML text holds, in ruamel's round-trip containers.

    Raises:
        YAMLError: It is not YAML, or stands for more than a file of ours ever does.
        ValueError: A number is too long.
        RecursionError: It is nested too deep to be read.
    """
    yaml = YAML(typ="rt", pure=True)
    yaml.Constructor = _Limited
    return yaml.load(text)


class _Limited(RoundTripConstructor):
    """Looks at the nodes of a text before it makes values of them."""

    def construct_document(self, node: Node) -> Any:
        if _extent(node, 1, {})[0] > _MOST_VALUES:
            _refuse(node, f"aliases that unfold to more than {_MOST_VALUES} values")
        return super().construct_document(node)


def _extent(node: Node, depth: int, known: dict[int, tuple[int, int]]) -> tuple[int, int]:
    """Return how many values a node at this depth unfolds to, and how deep they are nested."""
    if isinstance(node, ScalarNode):
        if _SURROGATE.search(node.value):
            _refuse(node, "half a character (a lone surrogate): write the character itself")
        return 1, 1
    if id(node) not in known and depth <= DEEPEST:  # deeper: perhaps in itself
        parts = node.value
        if isinstance(node, MappingNode):
            for key, _ in parts:
                if not isinstance(key, ScalarNode):
                    _refuse(key, "a list or a mapping as a key: a key is a word or a number")
            parts = [part for pair in parts for part in pair]
        inside = [_extent(part, depth + 1, known) for part in parts]
        sizes, heights = zip((0, 0), *inside, strict=True)
        known[id(node)] = 1 + sum(sizes), 1 + max(heights)
    size, height = known.get(id(node), (1, DEEPEST))
    if depth + height - 1 > DEEPEST:
        _refuse(node, f"nested more than {DEEPEST} deep, or in itself")
    return size, height


def _refuse(node: Node, problem: str) -> NoReturn:
    raise MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


def check(source: Source, spec: type[SpecT], keys: Sequence[Key] = ()) -> SpecT:
    """Check what stands at `keys` of the file against a specification.

    Args:
        source: The file.
        spec: A pydantic model.
        keys: Where in the file; empty for all of it.

    Raises:
        InputError: Every mistake, one a line, each with its line and field.
    """
    data = source.values
    for key in keys:
        data = data[key]
    try:
        return spec.model_validate(data)
    except ValidationError as error:
        # Only one branch of a union explains a mistake best: keep the first for each place that
        # takes what was given for what it is.
        best: dict[tuple[int | None, str | None], tuple[bool, InputError]] = {}
        for detail in error.errors():
            mistake = _mistake(source, spec, detail, keys)
            place, other_kind = (mistake.line, mistake.field), detail["type"].endswith("_type")
            if place not in best or best[place][0] > other_kind:
                best[place] = other_kind, mistake
        unique = [mistake for _, mistake in best.values()]
        if len(unique) == 1:
            raise unique[0] from error
        first = unique[0]
        rest = "\n".join(str(m) for m in unique[1:])
        raise InputError(
            f"{first.message}\n{rest}", file=first.file, line=first.line, field=first.field
        ) from error


def plain(data: Any) -> Any:
    """Return ruamel's containers and scalars as plain Python ones."""
    if isinstance(data, dict):
        # A number may count something; True is a number to Python, and no key of ours.
        return {key if type(key) is int else str(key): plain(v) for key, v in data.items()}
    if isinstance(data, list | tuple):
        return [plain(value) for value in data]
    if isinstance(data, bool) or data is None:
        return data
    for kind in (int, float, str):
        if isinstance(data, kind):
            return kind(data)
    return str(data)


_EXPECTED = {  # in the words of a file, where pydantic has those of Python
    **dict.fromkeys(("model_type", "dict_type"), "keys and values are expected"),
    **dict.fromkeys(("tuple_type", "list_type"), "a list is expected"),
    **dict.fromkeys(("float_type", "float_parsing"), "a number is expected"),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), "a whole number is expected"),
    **dict.fromkeys(("bool_type", "bool_parsing"), "true or false is expected"),
    "string_type": "text is expected",
}


def _mistake(
    source: Source, spec: type[BaseModel], detail: Any, prefix: Sequence[Key]
) -> InputError:
    # Pydantic puts names of union branches into the location: keep only keys the file has.
    keys: list[Key] = list(prefix)
    location, given, kind = detail["loc"], detail.get("input"), detail["type"]
    for part in location:
        if _holds(source.data, [*keys, part]):
            keys.append(part)
    if kind == "missing":
        keys.append(location[-1])
    if kind == "extra_forbidden":
        known = _known_keys(spec, location[:-1])
        message = f"unknown key: {nearest(str(location[-1]), known)}"
    elif kind == "missing" and isinstance(location[-1], int):
        keys.pop()
        message = f"too few values; given {given!r}"
    elif kind == "missing":
        message = "this key is missing"
    else:
        text = _EXPECTED.get(kind, detail["msg"].removeprefix("Value error, "))
        shown = repr(given) if len(repr(given)) < 80 else repr(given)[:77] + "..."
        message = text if kind == "value_error" else f"{text}; given {shown}"
    return source.error(message, keys)


def _holds(node: Any, keys: Sequence[Key]) -> bool:
    for key in keys:
        try:
            node = node[key]
        except (KeyError, IndexError, TypeError):
            return False
    return True


def _known_keys(spec: type[BaseModel], location: Sequence[Key]) -> list[str]:
    """Return the keys that the specification at `location` takes."""
    candidates: list[Any] = [spec]
    for part in location:
        following: list[Any] = []
        for model in candidates:
            fields = getattr(model, "model_fields", None)
            if fields is not None and part in fields:
                following += models_in(fields[part].annotation)
            elif getattr(model, "__name__", None) == part:
                following.append(model)
            else:
                following += models_in(model)
        candidates = following or candidates
    return sorted({key for model in candidates for key in getattr(model, "model_fields", {})})

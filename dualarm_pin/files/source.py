"""Read YAML from users and check it, with the line of every mistake.

YAML 1.2 through ruamel.yaml: no code is run, duplicate keys are errors, and every key keeps its
line. Pydantic models then check names, types and ranges; all mistakes are reported at once.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from dualarm_pin.errors import InputError, MissingFileError, nearest

SpecT = TypeVar("SpecT", bound="Spec")
Key = str | int
_MOST_VALUES = 1_000_000  # aliases of aliases in a small file can stand for billions
_LARGEST = 20_000_000  # bytes; a YAML file beyond this is a mistake


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

    def apply(self, data: Any) -> None:
        """Set the field in the data of a file, and make the mappings that lead to it.

        Raises:
            InputError: There is no such place.
        """
        field = f"--set {self.text}"
        node = data
        for position, key in enumerate(self.keys[:-1], 1):
            try:
                if isinstance(node, dict) and not isinstance(node.get(key), dict | list):
                    node[key] = CommentedMap()
                node = node[key]
            except (KeyError, IndexError, TypeError) as error:
                known = ".".join(map(str, self.keys[:position]))
                raise InputError(f"there is no {known} to set", field=field) from error
        try:
            node[self.keys[-1]] = self.value
        except (IndexError, TypeError) as error:
            raise InputError("there is no such place", field=field) from error


class Spec(BaseModel):
    """Base of every specification: unknown keys are errors, values are strict and frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


@dataclass(frozen=True)
class Source:
    """A YAML file as read: plain data, and where each key stands.

    Attributes:
        path: The file.
        data: What it holds; ruamel's round-trip containers, which remember their lines.
    """

    path: Path
    data: Any

    @cached_property
    def values(self) -> Any:
        """What it holds as plain Python values."""
        return plain(self.data)

    def changed(self, changes: Sequence[Change]) -> Source:
        """Return this file with other values at some places; it keeps its own."""
        data = copy.deepcopy(self.data)
        for change in changes:
            change.apply(data)
        return Source(self.path, data)

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
        """Return an error that names this file, the line and the field."""
        return InputError(
            message, file=self.path, line=self.line(keys), field=".".join(str(k) for k in keys)
        )

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
        InputError: It is not text, not YAML, or not a mapping.
    """
    path = Path(path)
    try:
        raw = path.read_bytes()
    except OSError as error:
        reason = "no such file" if isinstance(error, FileNotFoundError) else error.strerror
        raise MissingFileError(f"{reason}; give the path of a YAML file", file=path) from error
    if len(raw) > _LARGEST:
        raise InputError(f"{len(raw)} bytes is too large for a YAML file", file=path)
    return parse_yaml(raw, path)


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
        data = YAML(typ="rt", pure=True).load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = None if mark is None else mark.line + 1
        reason = (error.problem or error.context or "not YAML").strip()
        raise InputError(f"not valid YAML: {reason}", file=path, line=line) from error
    except (YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"not valid YAML: {str(error).splitlines()[0]}", file=path) from error
    if _size(data, {}) > _MOST_VALUES:
        raise InputError("its aliases unfold to too many values, or to themselves", file=path)
    if not isinstance(data, dict):
        given = "an empty file" if data is None else f"a {type(data).__name__}"
        raise InputError(f"{given} where keys and values are expected", file=path, line=1)
    return Source(path, data)


def _size(node: Any, known: dict[int, float]) -> float:
    """Return how many values a node unfolds to; infinite for one that holds itself."""
    if not isinstance(node, dict | list):
        return 1
    if id(node) not in known:
        known[id(node)] = math.inf  # until it is counted, so that a circle shows
        parts = node.values() if isinstance(node, dict) else node
        known[id(node)] = 1 + sum(_size(part, known) for part in parts)
    return known[id(node)]


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
        mistakes = [_mistake(source, spec, detail, keys) for detail in error.errors()]
        # Only one union branch explains a mistake best: keep the first for each place.
        unique = list({(str(m.line), m.field): m for m in reversed(mistakes)}.values())[::-1]
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
        return {key if isinstance(key, int) else str(key): plain(v) for key, v in data.items()}
    if isinstance(data, list | tuple):
        return [plain(value) for value in data]
    if isinstance(data, bool) or data is None:
        return data
    for kind in (int, float, str):
        if isinstance(data, kind):
            return kind(data)
    return str(data)


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
        message = f"unknown key: {nearest(str(keys[-1]), known)}"
    elif kind == "missing" and isinstance(location[-1], int):
        keys.pop()
        message = f"too few values; given {given!r}"
    elif kind == "missing":
        message = "this key is missing"
    else:
        text = detail["msg"].removeprefix("Value error, ")
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
                following += _models(fields[part].annotation)
            elif getattr(model, "__name__", None) == part:
                following.append(model)
            else:
                following += _models(model)
        candidates = following or candidates
    return sorted({key for model in candidates for key in getattr(model, "model_fields", {})})


def _models(annotation: Any) -> list[Any]:
    """Return the specifications inside a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in get_args(annotation) for model in _models(argument)]

"""Explain every key of a file: as text, and as JSON schemas that editors read."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel

from dualarm_pin.errors import UnknownNameError, nearest
from dualarm_pin.files.cell_spec import CellSpec
from dualarm_pin.files.documented import Documented, documented, first_line, models_in
from dualarm_pin.files.suite_spec import SuiteSpec
from dualarm_pin.files.write import write_files
from dualarm_pin.task.spec import TaskSpec

FILES: Final[dict[str, type[BaseModel]]] = {
    "cell": CellSpec,
    "task": TaskSpec,
    "suite": SuiteSpec,
}
_WIDTH = 88  # columns of the text


@dataclass(frozen=True)
class Key:
    """A key of a file.

    Attributes:
        place: `task.path.circle.radius`.
        said: What is said about it.
        required: It has no default.
        default: Its default; None for none.
        sections: What its value may hold, if that is a section.
    """

    place: str
    said: Documented
    required: bool
    default: Any
    sections: tuple[type[BaseModel], ...]


def keys_of(place: str, model: type[BaseModel]) -> list[Key]:
    """Return the keys of the section that stands at `place`."""
    said = documented(model)
    return [
        Key(
            f"{place}.{name}",
            said[name],
            field.is_required(),
            None if field.is_required() else field.get_default(call_default_factory=True),
            tuple(models_in(field.annotation)),
        )
        for name, field in model.model_fields.items()
        if name in said
    ]


def every_key() -> Iterator[Key]:
    """Yield the keys of all files, sections before what they hold."""
    for name, model in FILES.items():
        yield from _below(keys_of(name, model))


def _below(keys: list[Key]) -> Iterator[Key]:
    for key in keys:
        yield key
        for section in key.sections:
            yield from _below(keys_of(key.place, section))


def explain(what: str | None = None) -> str:
    """Return what is known about a file or a key, in words.

    Args:
        what: `cell`, `task` or `suite`; a key such as `path.corner`, or its last part; None for
            an overview.

    Raises:
        UnknownNameError: There is no such file or key.
    """
    if what is None:
        overview = "\n".join(_section(name, model, whole=False) for name, model in FILES.items())
        return f"{overview}\n`explain task`, `explain path.corner` or `explain fillet` say more."
    if what in FILES:
        return _section(what, FILES[what], whole=True)
    found = [key for key in every_key() if f".{key.place}".endswith(f".{what}")]
    if not found:
        known = {key.place.rpartition(".")[2] for key in every_key()}
        hint = nearest(what.rpartition(".")[2], sorted(known))
        raise UnknownNameError(f"no file or key {what!r}: {hint}", field="explain")
    return "\n".join(_one(key) for key in found)


def _section(name: str, model: type[BaseModel], *, whole: bool) -> str:
    title = f"{name}: {first_line(model)}"
    lines = [_line(key, key.place.partition(".")[2]) for key in keys_of(name, model)]
    if whole:
        lines = [
            _line(key, "  " * key.place.count(".", len(name) + 1) + key.place.rpartition(".")[2])
            for key in _below(keys_of(name, model))
        ]
    return "\n".join([title, *lines, ""])


def _line(key: Key, label: str) -> str:
    text = key.said.text + (" (needed)" if key.required else "")
    head = f"  {label:<24} "
    return textwrap.fill(text, _WIDTH, initial_indent=head, subsequent_indent=" " * len(head))


def _one(key: Key) -> str:
    said = key.said
    facts = {
        "unit": said.unit,
        "default": "none, it is needed" if key.required else shown(key.default),
        "example": f"{key.place.rpartition('.')[2]}: {shown(said.example)}",
    }
    lines = [
        key.place,
        textwrap.fill(said.text, _WIDTH, initial_indent="  ", subsequent_indent="  "),
    ]
    lines += [f"  {name:<8} {text}" for name, text in facts.items() if text]
    if key.sections:
        lines.append("  keys")
        lines += [
            _line(each, "  " + each.place.rpartition(".")[2])
            for section in key.sections
            for each in keys_of(key.place, section)
        ]
    return "\n".join(lines) + "\n"


def shown(value: Any) -> str | None:
    """Return a value as a file would give it, or None for one that says nothing."""
    if isinstance(value, BaseModel):
        value = value.model_dump(exclude_unset=True)
    if value is None or value in ([], {}):
        return None
    return value if isinstance(value, str) else json.dumps(value).replace('"', "")


def schemas() -> dict[str, bytes]:
    """Return the JSON schemas by name of file."""
    found = {}
    for name, model in FILES.items():
        schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": name}
        schema |= {k: v for k, v in model.model_json_schema().items() if k != "title"}
        found[f"{name}.schema.json"] = (json.dumps(schema, indent=1) + "\n").encode()
    return found


def write_schemas(folder: Path) -> list[Path]:
    """Write the JSON schemas into a folder and return the files.

    Raises:
        InputError: The folder cannot be written.
    """
    write_files(folder, files := schemas())
    return [folder / name for name in files]

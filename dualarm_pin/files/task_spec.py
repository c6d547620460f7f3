"""What a task file may say, and how `--set` changes it."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import YAMLError

from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.path_spec import PathSpec
from dualarm_pin.files.source import Key, Source, Spec, read_yaml

Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]
Weight = Annotated[float, Field(ge=0.0)]
INDEX_NAMES = (
    "force",
    "velocity",
    "yoshikawa",
    "inverse_condition_number",
    "smallest_singular_value",
)


class WeightedSpec(Spec):
    """Weights that every index takes."""

    task_weights: tuple[Weight, Weight, Weight, Weight, Weight, Weight] | None = None
    joint_weights: list[Weight] | None = None


class DirectedSpec(WeightedSpec):
    """An index along a direction: the tangent of the path, or a vector in e1 axes."""

    direction: Literal["tangent", "path"] | Three | Six = "path"


class IndexSpec(Spec):
    """One index, and the weight of the additive joint-centre term."""

    force: DirectedSpec | None = None
    velocity: DirectedSpec | None = None
    yoshikawa: WeightedSpec | None = None
    inverse_condition_number: WeightedSpec | None = None
    smallest_singular_value: WeightedSpec | None = None
    joint_centre: Weight = 0.0

    @model_validator(mode="before")
    @classmethod
    def _bare_key(cls, data: Any) -> Any:
        """Read `force:` without options as `force: {}`."""
        if isinstance(data, str):
            return {data: {}}
        if isinstance(data, dict):
            return {k: {} if v is None and k in INDEX_NAMES else v for k, v in data.items()}
        return data

    @model_validator(mode="after")
    def _exactly_one(self) -> IndexSpec:
        if len(self.given) != 1:
            raise ValueError(f"name exactly one of {', '.join(INDEX_NAMES)}")
        return self

    @property
    def given(self) -> list[str]:
        """Names of the indices that the file gives."""
        return [name for name in INDEX_NAMES if getattr(self, name) is not None]


class SmoothnessSpec(Spec):
    """lambda of (eq. 19), how joints count in a step, and whether lambda follows the arc length."""

    weight: Weight = 3.0
    metric: Literal["equal", "velocity"] | list[Weight] = "equal"
    per_arc_length: bool = False


class TwoStageSpec(Spec):
    """The paper's first stage: points (from 1) and lambda."""

    Gamma: list[Annotated[int, Field(ge=1)]] | Annotated[int, Field(ge=2)] | None = None
    smoothness: Weight = 1.5


class TaskSpec(Spec):
    """A task file."""

    cell: str | dict[str, Any]
    path: PathSpec
    index: IndexSpec = IndexSpec(force=DirectedSpec())
    smoothness: Weight | SmoothnessSpec = 3.0
    two_stage: TwoStageSpec = TwoStageSpec()


def read_task(
    path: str | Path, overrides: Sequence[str] = ()
) -> tuple[Source, Source, tuple[Key, ...]]:
    """Read a task file and the cell it names, with `key=value` overrides applied.

    Keys are dotted: `smoothness=30`, `path.corner.side=0.2`; those that begin with `cell.` reach
    into the cell: `cell.arms.arm2.base.xyz=[2.4, 0, 0]`.

    Returns:
        The task; the file that holds the cell; and where in that file the cell stands: a cell may
        be a file of its own or part of the task file.

    Raises:
        InputError: A file or an override cannot be read.
    """
    task = read_yaml(path)
    changes = [_change(override) for override in overrides]
    inside = isinstance(task.data.get("cell"), dict)
    own, cells = _split(changes, inside)
    task = Source(task.path, _changed(task.data, own))
    named = task.data.get("cell")
    if isinstance(named, dict):
        return task, task, ("cell",)
    if not isinstance(named, str):
        given = "this key is missing" if named is None else f"given {named!r}"
        raise task.error(f"the path of a cell file is expected; {given}", ["cell"])
    try:
        cell = read_yaml(task.path.parent / named)
    except MissingFileError as error:
        raise task.error(f"the cell {error}", ["cell"]) from error
    return task, Source(cell.path, _changed(cell.data, cells)), ()


@dataclass(frozen=True)
class _Change:
    keys: list[Key]
    value: Any
    text: str


def _change(override: str) -> _Change:
    key, separator, text = override.partition("=")
    if not separator or not key.strip():
        raise InputError("give key=value, such as smoothness=30", field=f"--set {override}")
    keys: list[Key] = [int(k) if k.isdigit() else k for k in key.strip().split(".")]
    return _Change(keys, _value(text, override), override)


def _split(changes: Sequence[_Change], inside: bool) -> tuple[list[_Change], list[_Change]]:
    """Return the changes of the task file and, with `cell.` taken off, those of the cell file."""
    if inside:
        return list(changes), []
    own = [c for c in changes if c.keys[0] != "cell" or len(c.keys) == 1]
    cell = [replace(c, keys=c.keys[1:]) for c in changes if c not in own]
    return own, cell


def _changed(data: Any, changes: Sequence[_Change]) -> Any:
    changed = copy.deepcopy(data)
    for change in changes:
        _set(changed, change.keys, change.value, change.text)
    return changed


def _value(text: str, override: str) -> Any:
    try:
        return YAML(typ="rt", pure=True).load(text)
    except (YAMLError, ValueError) as error:
        raise InputError(f"the value is not YAML: {text!r}", field=f"--set {override}") from error


def _set(data: Any, keys: Sequence[str | int], value: Any, override: str) -> None:
    node = data
    for position, key in enumerate(keys[:-1]):
        try:
            if isinstance(node, dict) and not isinstance(node.get(key), dict | list):
                node[key] = CommentedMap()
            node = node[key]
        except (KeyError, IndexError, TypeError) as error:
            known = ".".join(str(k) for k in keys[: position + 1])
            raise InputError(f"there is no {known} to set", field=f"--set {override}") from error
    try:
        node[keys[-1]] = value
    except (IndexError, TypeError) as error:
        raise InputError("there is no such place", field=f"--set {override}") from error

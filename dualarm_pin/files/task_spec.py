"""What a task file may say, and how `--set` changes it."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import YAMLError

from dualarm_pin.errors import InputError
from dualarm_pin.files.path_spec import PathSpec
from dualarm_pin.files.source import Source, Spec, read_yaml

Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]
Weight = Annotated[float, Field(ge=0.0)]
INDEX_NAMES = ("force", "velocity", "yoshikawa", "inverse_condition", "smallest_singular_value")


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
    inverse_condition: WeightedSpec | None = None
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
    """lambda of (19), how joints count in a step, and whether lambda follows the arc length."""

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


def read_task(path: str | Path, overrides: Sequence[str] = ()) -> tuple[Source, Source]:
    """Read a task file and the cell it names, with `key=value` overrides applied.

    Keys are dotted: `smoothness=30`, `path.corner.side=0.2`; those that begin with `cell.` reach
    into the cell: `cell.arms.arm2.base.xyz=[2.4, 0, 0]`.

    Returns:
        The task and the cell; a cell written inside the task file is a source of its own with the
        lines of that file.

    Raises:
        InputError: A file or an override cannot be read.
    """
    task = read_yaml(path)
    cell_changes, changes = [], []
    for override in overrides:
        key, separator, text = override.partition("=")
        keys = [int(k) if k.isdigit() else k for k in key.strip().split(".")]
        if not separator or not key.strip():
            raise InputError("give key=value, such as smoothness=30", field=f"--set {override}")
        value = _value(text, override)
        if keys[0] == "cell" and len(keys) > 1:
            cell_changes.append((keys[1:], value, override))
        else:
            changes.append((keys, value, override))
    data = copy.deepcopy(task.data)
    for keys, value, override in changes:
        _set(data, keys, value, override)
    task = Source(task.path, data)
    named = data.get("cell")
    if isinstance(named, dict):
        cell = Source(task.path, named)
    elif isinstance(named, str):
        cell = read_yaml(task.path.parent / named)
    elif named is None:
        raise task.error("this key is missing: name a cell file", ["cell"])
    else:
        raise task.error(f"the path of a cell file is expected; given {named!r}", ["cell"])
    if cell_changes:
        changed = copy.deepcopy(cell.data)
        for keys, value, override in cell_changes:
            _set(changed, keys, value, override)
        cell = Source(cell.path, changed)
    return task, cell


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

"""What the `clearance:` section of a task file may hold: `off`, a distance, or a mapping.

    clearance: {required: 0.02, pairs: {"arm1/link_6 arm2/link_6": 0.05, "part torch": off}}

Without `required` no pair may touch whose distance the path does not fix itself.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from dualarm_pin.cell import Cell
from dualarm_pin.cell.parts import Pair
from dualarm_pin.clearance.rule import ClearanceRule, checked_distance
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.files.source import Spec

_OFF = ("off", False)  # YAML 1.1 reads `off` as false


def _distance(value: Any) -> float | None:
    return None if value in _OFF and not _is_number(value) else checked_distance(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


Distance = Annotated[
    float | None,
    BeforeValidator(_distance),
    WithJsonSchema({"anyOf": [{"type": "number", "minimum": 0}, {"enum": _OFF}]}),
]


class ClearanceSpec(Spec):
    """The `clearance:` section: what must stay how far apart.

    Attributes:
        required: Least distance of every pair of bodies [m], or `off`; without it no pair may touch
            whose distance the path does not fix itself, such as `0.02`.
        pairs: Another distance [m], or `off`, for two bodies, named with a space between them, such
            as `{arm1/link_6 arm2/link_6: 0.05}`.
        between_points: Whether it holds between the points of the path too.
    """

    short = ({"type": "number", "minimum": 0}, {"enum": _OFF})

    required: Distance = 0.0
    pairs: dict[str, Distance] = Field(default_factory=dict)
    between_points: bool = True

    @model_validator(mode="before")
    @classmethod
    def _one_value(cls, data: Any) -> Any:
        """Read a distance or `off` alone as what is required."""
        return data if isinstance(data, dict) else {"required": data}


def load_clearance(spec: ClearanceSpec, cell: Cell) -> ClearanceRule | None:
    """Return the rule that a task file asks for, checked against its cell; None for `off`.

    Raises:
        InputError: A pair does not name two bodies of the cell, each once; the field says which.
    """
    pairs = {_two_bodies(text, cell.body_names): value for text, value in spec.pairs.items()}
    if spec.required is None and not any(value is not None for value in pairs.values()):
        return None
    spare = "required" not in spec.model_fields_set
    rule = ClearanceRule(spec.required, pairs, spec.between_points, spare)
    rule.check_names(cell.body_names)
    return rule


def _two_bodies(text: str, bodies: tuple[str, ...]) -> Pair:
    """Return the two names in a text; a name may hold spaces, so every cut is tried."""
    words = text.split()
    cuts = [(" ".join(words[:k]), " ".join(words[k:])) for k in range(1, len(words))]
    for first, second in cuts:
        if first in bodies and second in bodies:
            return first, second
    if text in bodies:
        message = f"expected two bodies with a space between; given one, {text!r}: name the other"
        raise InputError(message, field=f"clearance.pairs.{text}")
    if len(cuts) != 1:
        message = f"expected two bodies with a space between; given {text!r}"
        raise InputError(f"{message}; {nearest(text, bodies)}", field=f"clearance.pairs.{text}")
    return cuts[0]

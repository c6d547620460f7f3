"""What the page may ask, checked: every number finite and within reason."""

from __future__ import annotations

from typing import Annotated, TypeVar

from pydantic import Field, ValidationError

from dualarm_pin.errors import InputError
from dualarm_pin.files.source import Spec

Far = Annotated[float, Field(ge=-100.0, le=100.0)]  # m or rad
Range = tuple[float, float]
AskedT = TypeVar("AskedT", bound="Asked")


class State(Spec):
    """Where everything stands: what a page sends whole each time, so that none is lost.

    Attributes:
        change: Parameters, from where the task's cell stands [m or rad].
        smoothness: lambda of (eq. 19).
        clearance: What bodies must keep [m]; as in the task if None.
        limits: Bounds of the joints that differ from the task's [rad or m].
    """

    change: dict[str, Far] = Field(default_factory=dict)
    smoothness: Annotated[float, Field(ge=0.0, le=1e9)]
    clearance: Annotated[float, Field(ge=0.0, le=10.0)] | None = None
    limits: dict[str, Range] = Field(default_factory=dict)


class Asked(Spec):
    """What every request says.

    Attributes:
        page: Number of the page that asks.
    """

    page: int


class Look(Asked):
    """Whether a search has found anything.

    Attributes:
        frame: Number of the frame that the page has; one that is no other is not sent again.
    """

    frame: int | None = None


class Move(Asked):
    """Something has moved.

    Attributes:
        state: Where everything stands.
        search: Whether the full search should run there.
        motion: Number of a motion that was found before and may be good here.
        hurried: Whether answers come too slowly: then less of the pool is followed.
    """

    state: State
    search: bool = False
    motion: int | None = None
    hurried: bool = False


def asked(kind: type[AskedT], body: bytes) -> AskedT:
    """Return a request, or raise InputError for one that no page of ours sends."""
    try:
        return kind.model_validate_json(body)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        field = ".".join(map(str, first["loc"])) or "request"
        raise InputError(first["msg"], field=field) from error

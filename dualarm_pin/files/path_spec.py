"""What the `path:` section of a task file may hold.

One generator (or `csv`, `gcode`, `apt`), and how the tool is held:

    path:
      circle: {radius: 0.1, points: 49}      # or step: 0.005, the largest distance of neighbours
      rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]   # or rpy_deg: [180, 0, 0]
      orientation: constant                  # tangent | normal | normal_tangent
      free: none                             # spin | rotation; or a list, one for each point
      spin_axis: [0, 0, 1]                   # in e2, for free: spin
      frame: {xyz: [0, 0, 0], rpy_deg: [0, 0, 0]}   # moves the whole path within e1

Lengths in metres; angles in degrees where the key ends in `_deg`. What each key means stands in
the docstring of the generator of the same name in `dualarm_pin.path.generators`.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from dualarm_pin.files.cell_spec import PlacementSpec, Positive, Vector
from dualarm_pin.files.source import Spec

Count = Annotated[int, Field(ge=2, le=1_000_000)]
Plane = tuple[float, float]
Free = Literal["none", "spin", "rotation"]


class Sampled(Spec):
    """Where a curve gets its points: exactly one of the two."""

    points: Count | None = None
    step: Positive | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.points is None) == (self.step is None):
            given = "both are" if self.points is not None else "neither is"
            raise ValueError(f"give one of points and step: {given} given")
        return self


class Resampled(Spec):
    """A file of points: they stay as they are, or are resampled by one of the two."""

    file: str
    points: Count | None = None
    step: Positive | None = None

    @model_validator(mode="after")
    def _not_both(self) -> Self:
        if self.points is not None and self.step is not None:
            raise ValueError("give points or step, or neither: both are given")
        return self


class Placed(Sampled):
    """A curve about a vertical axis or in a horizontal plane of e1."""

    center: Plane = (0.0, 0.0)
    height: float = 0.3


class CornerSpec(Spec):
    """`paths.corner`."""

    side: float = 0.15
    fillet: float = 0.01
    height: float = 0.3
    points: list[Annotated[int, Field(ge=0, le=1_000_000)]] | Count | None = None
    step: Positive | None = None

    @model_validator(mode="after")
    def _not_both(self) -> Self:
        if self.points is not None and self.step is not None:
            raise ValueError("give points or step: both are given")
        return self


class PolylineSpec(Sampled):
    """`paths.polyline`."""

    vertices: list[Vector]
    fillet: float = 0.0
    closed: bool = False


class CircleSpec(Placed):
    """`paths.circle`."""

    radius: float
    start_deg: float = 0.0
    turns: float = 1.0


class ArcSpec(Placed):
    """`paths.arc`."""

    radius: float
    start_deg: float
    stop_deg: float


class HelixSpec(Placed):
    """`paths.helix`."""

    radius: float
    pitch: float
    turns: float
    start_deg: float = 0.0


class RasterSpec(Placed):
    """`paths.raster`."""

    width: float
    depth: float
    rows: int
    fillet: float = 0.0


class SineSpec(Placed):
    """`paths.sine`."""

    length: float
    amplitude: float = 0.01
    periods: float = 4.0


class FigureEightSpec(Placed):
    """`paths.figure_eight`."""

    radius: float


class DomeSpiralSpec(Placed):
    """`paths.dome_spiral`."""

    radius: float
    turns: float = 3.0
    inner_deg: float = 10.0
    outer_deg: float = 45.0
    height: float = 0.2


class TubeSeamSpec(Placed):
    """`paths.tube_seam`."""

    radius: float
    tube_radius: float
    tilt_deg: float = 45.0
    turns: float = 1.0
    start_deg: float = 0.0
    height: float = 0.25


class SplineSpec(Sampled):
    """`paths.spline`."""

    through: list[Vector]
    closed: bool = False


class CsvSpec(Resampled):
    """`paths.read_csv`."""

    smooth: bool = False


class GcodeSpec(Sampled):
    """`paths.read_gcode`."""

    file: str
    work_offset: Vector = (0.0, 0.0, 0.0)
    rapids: bool = False
    stretch: Annotated[int, Field(ge=1)] | None = None


class AptSpec(Resampled):
    """`paths.read_apt`."""

    rapids: bool = False
    stretch: Annotated[int, Field(ge=1)] | None = None


def _bare_name(value: object) -> object:
    """Read `csv: FILE` as `csv: {file: FILE}`."""
    return {"file": value} if isinstance(value, str) else value


class PathSpec(Spec):
    """The `path:` section: exactly one generator, and how the tool is held along it."""

    corner: CornerSpec | None = None
    polyline: PolylineSpec | None = None
    circle: CircleSpec | None = None
    arc: ArcSpec | None = None
    helix: HelixSpec | None = None
    raster: RasterSpec | None = None
    sine: SineSpec | None = None
    figure_eight: FigureEightSpec | None = None
    dome_spiral: DomeSpiralSpec | None = None
    tube_seam: TubeSeamSpec | None = None
    spline: SplineSpec | None = None
    csv: Annotated[CsvSpec, BeforeValidator(_bare_name)] | None = None
    gcode: GcodeSpec | None = None
    apt: Annotated[AptSpec, BeforeValidator(_bare_name)] | None = None

    rotation: tuple[Vector, Vector, Vector] | None = None
    rpy_deg: Vector | None = None
    orientation: Literal["constant", "tangent", "normal", "normal_tangent"] | None = None
    free: Free | list[Free] = "none"
    spin_axis: Vector = (0.0, 0.0, 1.0)
    frame: PlacementSpec | None = None

    @property
    def generator(self) -> str:
        """Name of the one generator that is given."""
        return next(name for name in GENERATORS if getattr(self, name) is not None)

    @model_validator(mode="after")
    def _one_generator(self) -> Self:
        given = [name for name in GENERATORS if getattr(self, name) is not None]
        if len(given) != 1:
            shown = ", ".join(given) or "none"
            known = ", ".join(GENERATORS)
            raise ValueError(f"exactly one curve is expected; given {shown}; known: {known}")
        if self.rotation is not None and self.rpy_deg is not None:
            raise ValueError("give rotation or rpy_deg: both are given")
        return self


GENERATORS = tuple(PathSpec.model_fields)[: list(PathSpec.model_fields).index("rotation")]
"""Keys of `PathSpec` of which exactly one is given."""

"""What a suite file may say: tasks, methods, seeds, budgets, overrides, gates."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from dualarm_pin.files.numbers import Number, Seconds, Seed, Starts
from dualarm_pin.files.source import Spec

_MOST_STEPS = 1_000  # a count beyond is a slip


class NamedEntry(Spec):
    """An entry of a list that may also be written as one word, its `main` field."""

    main: ClassVar[str]
    short = ({"type": "string"},)

    @model_validator(mode="before")
    @classmethod
    def _one_word(cls, data: Any) -> Any:
        return {cls.main: data} if isinstance(data, str) else data


class StepsSpec(Spec):
    """Evenly spaced values, both ends included.

    Attributes:
        first: First value, such as `0.0`.
        last: Last value, such as `1.0`.
        count: How many, such as `11`.
    """

    first: Number
    last: Number
    count: Annotated[int, Field(ge=2, le=_MOST_STEPS)]

    @property
    def values(self) -> list[float]:
        """The values; rounded to 12 digits, so that 0.1 + 0.2 is 0.3 in names and keys."""
        step = (self.last - self.first) / (self.count - 1)
        return [round(self.first + i * step, 12) for i in range(self.count)]


class OverridesSpec(Spec):
    """Changes of any field of the task; keys that begin with `cell.` reach into the cell.

    Attributes:
        grid: Values by key, such as `{smoothness: [1, 3, 10]}`; every combination is a variant.
        variants: Sets of changes, such as `[{smoothness: 30}]`; each is a variant, combined with
            every point of the grid.
    """

    grid: dict[str, Annotated[list[Any], Field(min_length=1)] | StepsSpec] = Field(
        default_factory=dict
    )
    variants: list[dict[str, Any]] = Field(default_factory=list)


class TaskEntry(NamedEntry):
    """One task file, or a glob of them.

    Attributes:
        file: Path or glob, relative to the suite file, such as `tasks/*.yaml`.
        name: Name in tables, such as `corner`; the name of the file if not given.
        overrides: Changes for this task alone, on top of those of the suite.
    """

    main = "file"

    file: str
    name: str | None = None
    overrides: OverridesSpec = OverridesSpec()


class MethodEntry(NamedEntry):
    """One method with its options.

    Attributes:
        method: A method of `dualarm-pin solve`, or of an extra, such as `global`.
        call: `module:function` instead of a method: your own planner, called as, such as
            `my_planner:plan`
            `function(task, seed=..., **options)`; it returns a `Trajectory`.
        name: Name in tables, such as `quick`.
        effort: As in `solve`, such as `quick`.
        solver: As in `solve`, such as `engine`.
        starts: As in `solve`, such as `100`.
        options: Arguments of `call`, such as `{k0: 2.0}`.
        seeds: Seeds of this method alone, such as `[0, 1]`.
        time_limit: Budget of a run of this method [s], such as `60`.
    """

    main = "method"

    method: str | None = None
    call: Annotated[str, Field(pattern=r"^[\w.]+:\w+$")] | None = None
    name: str | None = None
    effort: str | None = None
    solver: str | None = None
    starts: Starts | None = None
    options: dict[str, Any] = Field(default_factory=dict)
    seeds: Starts | list[Seed] | None = None
    time_limit: Seconds | None = None

    @model_validator(mode="after")
    def _one_of_two(self) -> MethodEntry:
        if (self.method is None) == (self.call is None):
            raise ValueError("name either a `method` or a function to `call`")
        if self.call is None and self.options:
            raise ValueError("`options` belong to `call`; a method takes effort, solver, starts")
        return self


class GateEntry(NamedEntry):
    """A condition that the finished table must meet.

    Attributes:
        gate: A column, a comparison and a number, such as `mean_index <= 0.41`, such as `mean_index
            <= 0.41`.
        of: Whether every run, the best of them, their median or their mean must hold.
        task: Name or glob of tasks.
        method: Name or glob of methods.
    """

    main = "gate"

    gate: str
    of: Literal["every", "best", "median", "mean"] = "every"
    task: str = "*"
    method: str = "*"


class MapEntry(Spec):
    """A map of the best value over two keys of the grid, for the report.

    Attributes:
        x: Key of the grid along the horizontal axis, such as `cell.arms.arm2.base.xyz.0`.
        y: Key of the grid along the vertical axis, such as `cell.arms.arm2.base.xyz.1`.
        of: Column whose best value is drawn.
        label_x: What the axis says, such as `x of the base [m]`.
        label_y: What the axis says, such as `y of the base [m]`.
    """

    x: str
    y: str
    of: str = "mean_index"
    label_x: str | None = None
    label_y: str | None = None


class SuiteSpec(Spec):
    """A suite file.

    Attributes:
        title: Heading of the report, such as `Two robots`.
        tasks: Task files.
        methods: Methods.
        seeds: The seeds, or how many: 3 stands for 0, 1, 2.
        time_limit: Budget of a run [s].
        overrides: Changes of every task.
        gates: What must hold for exit code 0.
        maps: Maps over two keys of the grid.
        keep: Which trajectories are kept: the best of every task and variant, all, or none.
        limitations: What a reader should know about this suite, such as `[The meshes are hulls.]`;
            one sentence each.
    """

    title: str | None = None
    tasks: Annotated[list[TaskEntry], Field(min_length=1)]
    methods: Annotated[list[MethodEntry], Field(min_length=1)]
    seeds: Starts | Annotated[list[Seed], Field(min_length=1)] = 1
    time_limit: Seconds = 600.0
    overrides: OverridesSpec = OverridesSpec()
    gates: list[GateEntry] = Field(default_factory=list)
    maps: list[MapEntry] = Field(default_factory=list)
    keep: Literal["best", "all", "none"] = "best"
    limitations: list[str] = Field(default_factory=list)

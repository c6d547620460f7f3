"""Suite: the runs that a suite file asks for, checked before the first one starts."""

from __future__ import annotations

import glob
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dualarm_pin import __version__
from dualarm_pin.bench.fingerprints import Fingerprints
from dualarm_pin.bench.gates import Gate, read_gate
from dualarm_pin.bench.run import BenchRun, Method, changes
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.files.call import refuse_calls
from dualarm_pin.files.source import Key, Source, check, read_yaml
from dualarm_pin.files.suite_spec import MethodEntry, OverridesSpec, StepsSpec, SuiteSpec
from dualarm_pin.planners.methods import EFFORTS, METHODS

_Task = tuple[Path, OverridesSpec, Sequence[Key]]
_MOST_RUNS = 100_000  # more is a slip in a grid, and they are all held in memory
_MOST_VARIANTS = 10_000  # of a task; each is read and checked before the first run


@dataclass(frozen=True)
class Suite:
    """A batch, complete.

    Attributes:
        file: The suite file.
        text: What it says, for the report.
        spec: The same, read.
        runs: All runs, in the order of the table.
        gates: What must hold.
    """

    file: Path
    text: str
    spec: SuiteSpec
    runs: tuple[BenchRun, ...]
    gates: tuple[Gate, ...]

    @property
    def title(self) -> str:
        """Heading of the report."""
        return self.spec.title or self.file.stem

    @classmethod
    def load(cls, file: str | Path, *, allow_code: bool = False) -> Suite:
        """Read a suite file and everything it names.

        Args:
            file: The suite file (YAML).
            allow_code: Its runs import and run the functions that it and its tasks `call`.

        Raises:
            InputError: The suite, or a task that it names, is wrong: file, line and field.
        """
        source = read_yaml(file)
        refuse_calls(source, allow_code=allow_code)
        spec = check(source, SuiteSpec)
        tasks = dict(_tasks(source, spec))
        methods = list(_methods(source, spec))
        _refuse_too_many(source, spec, tasks, methods)
        runs = tuple(_runs(source, spec, tasks, methods, allow_code))
        names = list(tasks), [method.name for method, _ in methods]
        gates = []
        for i, entry in enumerate(spec.gates):
            try:
                gates.append(read_gate(entry, *names))
            except InputError as error:
                raise source.error(error.message, ["gates", i]) from error
        for i, chart in enumerate(spec.maps):
            for axis in (chart.x, chart.y):
                if axis not in spec.overrides.grid:
                    hint = nearest(axis, spec.overrides.grid)
                    raise source.error(f"{axis!r} is no key of overrides.grid: {hint}", ["maps", i])
        text = source.path.read_text(encoding="utf-8-sig")
        return cls(source.path, text, spec, runs, tuple(gates))


def _tasks(source: Source, spec: SuiteSpec) -> Iterator[tuple[str, _Task]]:
    taken: dict[str, Path] = {}
    for i, entry in enumerate(spec.tasks):
        keys: list[Key] = ["tasks", i]
        pattern = str(source.path.resolve().parent / entry.file)
        files = [Path(name) for name in sorted(glob.glob(pattern, recursive=True))]
        if not files:
            what = "glob matches no file" if glob.has_magic(entry.file) else "file does not exist"
            raise source.error(f"this {what}: {entry.file}", keys)
        if entry.name is not None and len(files) > 1:
            raise source.error(f"one name for {len(files)} tasks: leave `name` out", keys)
        for file in files:
            name = entry.name or file.stem
            if name in taken:
                raise source.error(
                    f"two tasks are called {name!r} ({taken[name]} and {file}): give one a `name`",
                    keys,
                )
            taken[name] = file
            yield name, (file, entry.overrides, keys)


def _methods(source: Source, spec: SuiteSpec) -> Iterator[tuple[Method, MethodEntry]]:
    taken: set[str] = set()
    for i, entry in enumerate(spec.methods):
        keys: list[Key] = ["methods", i]
        if entry.method is not None:
            _known(source, keys, "method", entry.method, tuple(METHODS))
            if entry.solver is not None:
                _known(source, keys, "solver", entry.solver, tuple(METHODS[entry.method].solvers))
        if entry.effort is not None:
            _known(source, keys, "effort", entry.effort, EFFORTS)
        named = entry.model_dump(include={"effort", "solver", "starts"}, exclude_none=True)
        starts = f"{entry.starts} starts" if entry.starts else None
        words = [entry.method or entry.call, entry.solver, entry.effort, starts]
        name = entry.name or " ".join(filter(None, words))
        if name in taken:
            raise source.error(f"two methods are called {name!r}: give one a `name`", keys)
        taken.add(name)
        yield Method(name, entry.method, entry.call, entry.options | named), entry


def _known(
    source: Source, keys: Sequence[Key], field: str, given: str, known: Sequence[str]
) -> None:
    if given not in known:
        where = [*keys, field] if isinstance(source.data["methods"][keys[-1]], dict) else keys
        raise source.error(f"unknown {field} {given!r}: {nearest(given, known)}", where)


def _refuse_too_many(
    source: Source,
    spec: SuiteSpec,
    tasks: Mapping[str, _Task],
    methods: Sequence[tuple[Method, MethodEntry]],
) -> None:
    """Count the runs without making them.

    Raises:
        InputError: There are more than a suite may have.
    """
    variants = 0
    for name, (_, own, _) in tasks.items():
        count = math.prod(len(axis) for axis in _axes(spec.overrides, own))
        if count > _MOST_VARIANTS:
            message = (
                f"{count} variants of {name!r}: {_MOST_VARIANTS} are allowed, divide the suite"
            )
            raise source.error(message, ["overrides"])
        variants += count
    seeds = (spec.seeds if entry.seeds is None else entry.seeds for _, entry in methods)
    runs = variants * sum(each if isinstance(each, int) else len(each) for each in seeds)
    if runs > _MOST_RUNS:
        message = f"{runs} runs: {_MOST_RUNS} are allowed, divide the suite"
        raise source.error(message, ["seeds"])


def _runs(
    source: Source,
    spec: SuiteSpec,
    tasks: Mapping[str, _Task],
    methods: Sequence[tuple[Method, MethodEntry]],
    allow_code: bool,
) -> Iterator[BenchRun]:
    prints = Fingerprints()
    taken: dict[str, BenchRun] = {}
    for name, (file, own, keys) in tasks.items():
        for overrides in _variants(spec.overrides, own):
            try:
                inputs = prints.read(file, changes(overrides), allow_code=allow_code)
            except InputError as error:
                if error.field is not None and error.field.startswith("--set "):
                    raise source.error(
                        f"{error.field.removeprefix('--set ')}: {error.message}", ["overrides"]
                    ) from error
                raise
            for method, entry in methods:
                seeds = spec.seeds if entry.seeds is None else entry.seeds
                for seed in range(seeds) if isinstance(seeds, int) else seeds:
                    run = BenchRun(
                        task=name,
                        file=str(file.resolve()),
                        overrides=overrides,
                        inputs=inputs,
                        method=method,
                        seed=seed,
                        time_limit=entry.time_limit or spec.time_limit,
                        version=__version__,
                        allow_code=allow_code,
                    )
                    twin = taken.setdefault(run.key, run)
                    if twin is not run:
                        raise source.error(
                            f"{method.name!r} on {name!r} with seed {seed} is the same run "
                            f"as {twin.method.name!r} on {twin.task!r}: leave one out",
                            keys,
                        )
                    yield run


def _variants(suite: OverridesSpec, task: OverridesSpec) -> Iterator[Mapping[str, Any]]:
    """Every combination of the suite's and the task's grids and lists."""
    for parts in itertools.product(*_axes(suite, task)):
        yield {key: value for part in parts for key, value in part.items()}


def _axes(suite: OverridesSpec, task: OverridesSpec) -> list[Sequence[Mapping[str, Any]]]:
    """Return the changes along each axis of the grids, and the lists."""
    grids = suite.grid | task.grid
    axes: list[Sequence[Mapping[str, Any]]] = [
        [{key: value} for value in (steps.values if isinstance(steps, StepsSpec) else steps)]
        for key, steps in grids.items()
    ]
    return axes + [entry.variants for entry in (suite, task) if entry.variants]

"""Do one run: load the task, call the method, return the figures of its row."""

from __future__ import annotations

import importlib
import time
import traceback
from collections.abc import Callable
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path

from dualarm_pin import __version__
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.bench.columns import Answered, machine, of_answer
from dualarm_pin.bench.fingerprints import file_digest
from dualarm_pin.bench.run import BenchRun, RunOutcome, changes
from dualarm_pin.errors import DualArmError, InputError
from dualarm_pin.task import Task

Planner = Callable[[], Trajectory]


def perform(
    run: BenchRun, keep: bool = True, loaded: Callable[[], None] = lambda: None
) -> RunOutcome:
    """Do a run here and now, without a time limit; never raises for what the run does.

    Args:
        run: The run.
        keep: Return the trajectory too.
        loaded: Called before the planner is, so that a time limit counts its own work alone.
    """
    try:
        task, planner = _prepare(run)
    except Exception as error:
        return _failed(error)
    loaded()
    started = datetime.now(UTC)
    begun = time.perf_counter()
    try:
        trajectory = planner()
        if not isinstance(trajectory, Trajectory):
            raise TypeError(f"a Trajectory is expected; {run.method.name} returned {trajectory!r}")
        answered = Answered(task, trajectory, started, time.perf_counter() - begun)
        figures = of_answer(answered)
    except Exception as error:
        return _failed(error)
    return RunOutcome(
        status="ok" if trajectory.found else "not_found",
        reason="" if trajectory.found else trajectory.message or "no solution was found",
        figures=figures,
        trajectory=trajectory if keep else None,
        task_file=_task_file(task) if keep and task.record is not None else None,
    )


def _prepare(run: BenchRun) -> tuple[Task, Planner]:
    """Load what a run needs.

    Raises:
        InputError: Files changed since the batch began, or the worker has another version.
        DualArmError: As `Task.load`.
    """
    if run.version != __version__:
        raise InputError(
            f"this worker has dualarm-pin {__version__}, the batch {run.version}: "
            "install the same version everywhere"
        )
    for file, expected in run.inputs.files.items():
        try:
            same = file_digest(Path(file)) == expected
        except OSError as error:
            raise InputError(
                f"this worker cannot read it ({error.strerror}): workers on other machines need "
                "the same files at the same paths",
                file=file,
            ) from error
        if not same:
            raise InputError("the file changed since the batch began", file=file)
    task = _task(run.file, changes(run.overrides), run.allow_code)
    return task, _planner(run, task)


def _failed(error: Exception) -> RunOutcome:
    """Return the outcome of a run that raised."""
    text = str(error) or type(error).__name__
    if not isinstance(error, DualArmError):
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(frame.filename).name}:{frame.lineno}"
        text = f"{type(error).__name__}: {text} ({place})"
    return RunOutcome("failed", " ".join(text.split())[:2000], {"machine": machine()})


@lru_cache(maxsize=8)
def _task(file: str, changes: tuple[str, ...], allow_code: bool) -> Task:
    return Task.load(file, changes, allow_code=allow_code)


@lru_cache(maxsize=8)
def _task_file(task: Task) -> str:
    return task.as_yaml()  # writing YAML takes longer than a short run


def _planner(run: BenchRun, task: Task) -> Planner:
    method = run.method
    if method.call is not None:
        module, _, name = method.call.partition(":")
        function = getattr(importlib.import_module(module), name)
        return lambda: function(task, seed=run.seed, **method.options)
    from dualarm_pin.planners.methods import plan

    planner = method.planner
    assert planner is not None  # a method has a planner or a call
    if planner == "global":
        from dualarm_pin.solvers import interior_point as engine

        engine.ensure_compiled()
    return lambda: plan(task, planner, seed=run.seed, jobs=1, **method.options)

"""One call for every method by its name: what the command line and batches use."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, get_args

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.planners.local import VARIANTS, plan_local
from dualarm_pin.planners.peers import plan_casadi, plan_pink
from dualarm_pin.planners.two_stage import plan_two_stage
from dualarm_pin.planners.whole_path import Effort, plan_global
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solvers.casadi_ipopt import PLUGINS

if TYPE_CHECKING:
    from dualarm_pin.task import Task

EFFORTS: tuple[str, ...] = get_args(Effort)
SOLVERS: dict[str, tuple[str, ...]] = {
    "global": ("engine",),
    "two-stage": ("nlopt-slsqp",),
    "local": VARIANTS,
    "casadi": PLUGINS,
    "pink": ("relative-frame",),
}
METHODS = tuple(SOLVERS)


def plan(
    task: Task,
    method: str = "global",
    *,
    effort: str = "normal",
    solver: str | None = None,
    starts: int | None = None,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> Trajectory:
    """Plan with a method given by name.

    Args:
        task: What is asked.
        method: `global`, `two-stage` or `local`; `casadi` and `pink` need their extras.
        effort: `quick`, `normal` or `thorough`; for `global` alone.
        solver: One of `SOLVERS[method]`; None takes the method's default.
        starts: Number of starts; None takes the method's default.
        seed: Seed of the starts.
        jobs: Threads or processes; None takes the processors there are.
        progress: Told where the work stands.

    Raises:
        UnknownNameError: No such method, effort or solver.
        InputError: A number is out of range.
    """
    _known("method", method, METHODS)
    _known("effort", effort, EFFORTS)
    if solver is not None:
        _known("solver", solver, SOLVERS[method])
    for name, number in (("starts", starts), ("jobs", jobs)):
        if number is not None and number < 1:
            raise InputError(f"at least 1 is expected; given {number}", field=f"--{name}")
    if seed < 0:
        raise InputError(f"0 or more is expected; given {seed}", field="--seed")
    if method == "global":
        return plan_global(
            task, effort=effort, starts=starts, seed=seed, jobs=jobs, progress=progress
        )
    if method == "two-stage":
        return plan_two_stage(task, starts=starts or 100, seed=seed, jobs=jobs, progress=progress)
    if method == "casadi":
        return plan_casadi(
            task, plugin=solver or "ipopt", starts=starts or 10, seed=seed, progress=progress
        )
    if method == "pink":
        return plan_pink(task, starts=starts or 20, seed=seed, progress=progress)
    variant = next(v for v in VARIANTS if v == (solver or "qp"))
    return plan_local(task, variant=variant, seed=seed, starts=starts or 20, progress=progress)


def _known(field: str, given: str, known: Sequence[str]) -> None:
    if given not in known:
        allowed = ", ".join(known)
        raise UnknownNameError(
            f"unknown {field} {given!r}: {nearest(given, known)} (allowed: {allowed})",
            field=f"--{field}",
        )

"""One call for every method by its name: what the command line and batches use.

A method is one entry of `METHODS`. A planner of your own needs none: `plan(task, my_planner)`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, get_args

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.files.numbers import check_counts
from dualarm_pin.planners.feed import plan_feed
from dualarm_pin.planners.local import VARIANTS, plan_local
from dualarm_pin.planners.peers import plan_casadi, plan_pink
from dualarm_pin.planners.two_stage import plan_two_stage
from dualarm_pin.planners.whole_path import Effort, plan_global
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solvers.casadi_ipopt import PLUGINS
from dualarm_pin.solvers.shipped import SOLVERS
from dualarm_pin.solvers.solver import Solver, error_about, name_of

if TYPE_CHECKING:
    from dualarm_pin.task import Task

MOST_ALTERNATIVES = 20  # as many as a search keeps
EFFORTS: tuple[str, ...] = get_args(Effort)


@dataclass(frozen=True)
class PlannerEntry:
    """A planner that has a name.

    Attributes:
        function: Called with the task, `seed`, `progress` and what of the rest it takes.
        solvers: What `--solver` may name, and what the function gets for it.
        keyword: Under which keyword it gets that.
        options: Which of `effort`, `starts`, `jobs`, `time_limit`, `warm` and `alternatives` it
            takes.
    """

    function: Callable[..., Trajectory]
    solvers: Mapping[str, Any]
    keyword: str = "solver"
    options: tuple[str, ...] = ("starts",)


AIMS = {"index": "global", "feed": "feed"}
"""The method of each aim."""

METHODS: dict[str, PlannerEntry] = {
    "global": PlannerEntry(
        plan_global,
        SOLVERS,
        options=("effort", "starts", "jobs", "time_limit", "warm", "alternatives"),
    ),
    "feed": PlannerEntry(plan_feed, {}, options=("effort", "starts", "jobs")),
    "two-stage": PlannerEntry(plan_two_stage, SOLVERS, options=("starts", "jobs")),
    "local": PlannerEntry(plan_local, {name: name for name in VARIANTS}, "variant"),
    "casadi": PlannerEntry(plan_casadi, {name: name for name in PLUGINS}, "plugin"),
    "pink": PlannerEntry(plan_pink, {}),
}


def plan(
    task: Task,
    method: str | Callable[..., Trajectory] | None = None,
    *,
    effort: str = "normal",
    solver: str | Solver | None = None,
    starts: int | None = None,
    time_limit: float | None = None,
    seed: int = 0,
    jobs: int | None = None,
    warm: Trajectory | None = None,
    alternatives: int = 1,
    progress: Progress = SILENT,
) -> Trajectory:
    """Plan with a method given by name, or with a planner of your own.

    Args:
        task: What is asked.
        method: A name in `METHODS`, or a function (task, seed=...) that returns a `Trajectory`;
            None takes that of the task, else that of its aim.
        effort: `quick`, `normal` or `thorough`; for `global` and `feed`.
        solver: A name that the method knows, or a `Solver` where it takes any; None takes that of
            the task, else the method's default.
        starts: Number of starts; None takes the method's default.
        time_limit: Seconds after which the search is cut, for the global method.
        seed: Seed of the starts.
        jobs: Threads or processes; None takes the processors there are.
        warm: An earlier result to start from too, for the global method.
        alternatives: How many answers that differ in posture, for the global method.
        progress: Told where the work stands.

    Raises:
        UnknownNameError: No such method, effort or solver.
        InputError: A number is out of range, or a function of your own returns something else.
    """
    method = method or task.method or AIMS[task.aim]
    check_counts(starts, seed, jobs)
    if time_limit is not None and not time_limit > 0.0:
        raise InputError(f"seconds above 0 are expected; given {time_limit}", field="--time-limit")
    if not 1 <= alternatives <= MOST_ALTERNATIVES:
        message = f"1 to {MOST_ALTERNATIVES} is expected; given {alternatives}"
        raise InputError(message, field="--alternatives")
    asked = {"--warm": warm is not None, "--alternatives": alternatives > 1}
    ends = {name: getattr(task, name) is not None for name in ("from_posture", "to_posture")}
    for name, wanted in (asked | (ends if isinstance(method, str) else {})).items():
        if wanted and method != "global":
            message = f"the method {name_of(method)!r} has no use for it; take global"
            raise InputError(message, field=name)
    if not isinstance(method, str):
        answer = method(task, seed=seed)
        if not isinstance(answer, Trajectory):
            raise error_about(method, f"a Trajectory is expected; it returned {answer!r:.80}")
        return answer
    _known("method", method, METHODS)
    _known("effort", effort, EFFORTS)
    entry = METHODS[method]
    given: dict[str, Any] = {
        "effort": effort,
        "starts": starts,
        "jobs": jobs,
        "time_limit": time_limit,
    }
    given |= {"warm": warm, "alternatives": alternatives}
    arguments: dict[str, Any] = {n: given[n] for n in entry.options if given[n] is not None}
    solver = solver or task.solver
    if isinstance(solver, str):
        _known("solver", solver, entry.solvers)
        arguments[entry.keyword] = entry.solvers[solver]
    elif solver is not None and entry.solvers is not SOLVERS:
        allowed = ", ".join(entry.solvers) or "none"
        raise error_about(solver, f"the method {method!r} takes no solver but its own: {allowed}")
    elif solver is not None:
        arguments["solver"] = solver
    return entry.function(task, seed=seed, progress=progress, **arguments)


def _known(field: str, given: str, known: Sequence[str] | Mapping[str, Any]) -> None:
    if given not in known:
        hint, allowed = nearest(given, known), ", ".join(known) or "none"
        advice = f"{hint} Allowed: {allowed}" if hint.startswith("did you") else f"use {allowed}"
        raise UnknownNameError(f"unknown {field} {given!r}: {advice}", field=f"--{field}")

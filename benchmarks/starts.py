"""Why a start costs what it costs: how the starts of the whole-path law end, task by task.

    python benchmarks/starts.py --starts 100 --tasks b03,b04

Prints one row a task: milliseconds and iterations a start, how they ended, which share of the
iterations the worst tenth of the starts took, how many ends are singular (some Jacobian of the
free joints nearly loses a rank), and what dropping the hopeless ones saves: starts above the
tenth-best end, with a limit there.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import STATUS
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task import Task
from dualarm_pin.tolerance import TOLERANCE

TASKS = ["paper_corner", "circle", *(f"b{number:02d}" for number in range(1, 13))]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tasks", default=",".join(TASKS))
    given = parser.parse_args()
    engine.ensure_compiled(print)
    print("| task | k x n | ms | iterations | ends | worst tenth | singular | saved by dropping |")
    print("|---|---|---|---|---|---|---|---|")
    for name in given.tasks.split(","):
        problem = Task.load(urdf_folder() / "tasks" / f"{name}.yaml").problem()
        print(f"| {name} | {row(problem, given.starts, given.seed)} |", flush=True)


def row(problem: Problem, starts: int, seed: int) -> str:
    """Return the cells of one task."""
    drawn = common_postures(problem.lower, problem.upper, problem.k, starts, generator(seed, 20, 0))
    begun = time.process_time()
    ends = engine.solve_many(problem, drawn, jobs=1)
    cost = time.process_time() - begun
    spent = np.sort(ends.iterations)[::-1]
    worst = spent[: max(1, starts // 10)].sum() / max(1, spent.sum())
    counts = np.bincount(ends.status, minlength=len(STATUS))
    how = ", ".join(f"{STATUS[at]} {count}" for at, count in enumerate(counts) if count)
    good = np.flatnonzero(ends.converged)
    singular = sum(_sigma(problem, ends.q[end]) < TOLERANCE.singular for end in good)
    saved = "none converged"
    if len(good):
        limit = np.sort(ends.objective[good])[len(good) // 10]
        limited = engine.solve_many(problem, drawn, jobs=1, limit=limit)
        saved = f"{100.0 * (1.0 - limited.iterations.sum() / spent.sum()):.0f} %"
    return (
        f"{problem.k} x {problem.n} | {1e3 * cost / starts:.1f} | {np.median(spent):.0f} | {how} | "
        f"{100.0 * worst:.0f} % | {singular} of {len(good)} | {saved}"
    )


def _sigma(problem: Problem, q: np.ndarray) -> float:
    """Return the smallest singular value of the rows of any point."""
    at = evaluate(problem, q)
    return min(
        float(np.linalg.svd(at.jacobian[i, : problem.row_count[i]], compute_uv=False)[-1])
        for i in range(problem.k)
    )


if __name__ == "__main__":
    main()

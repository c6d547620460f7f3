"""Every index against force: time a point and iteration, share of starts that converge.

Run `python benchmarks/indices.py [--starts N] [--only NAME ...]`: all tasks that ship, and two
made-up cells with paths that they reach. It fails where an index takes more than LARGEST_RATIO
times as long as force (the median over the tasks), or converges less often over all of them.
Starts are minima of the index at the middle point alone, at every point; seconds are those of the
processor.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pinocchio as pin

import dualarm_pin as dp
from dualarm_pin.engine.solve import solve, solve_many
from dualarm_pin.errors import DualArmError
from dualarm_pin.indices import INDICES
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import distinct

LARGEST_RATIO = 3.0  # of the time that force takes
SLACK = 0.05  # of the share that converges: a few hundred starts tell no less
MADE_UP = {"b02": 3, "b06": 4}  # robots of 7 + 7 and 7 + 6 joints, placed by these seeds


def tasks(only: list[str]) -> Iterator[tuple[str, dp.Task]]:
    """Yield the tasks that ship and can be loaded, then the made-up ones."""
    files = sorted((dp.urdf_folder() / "tasks").glob("*.yaml"))
    loaded = {}
    for file in files:
        try:
            loaded[file.stem] = dp.Task.load(file)
        except DualArmError as error:
            print(f"{file.stem}: left out, {error}")
    found = loaded | {
        f"made up {name}": made_up(loaded[name], seed)
        for name, seed in MADE_UP.items()
        if name in loaded
    }
    yield from ((name, task) for name, task in found.items() if not only or name in only)


def made_up(task: dp.Task, seed: int) -> dp.Task:
    """Return the task's robots on other bases, with a helix about where a posture leads them."""
    rng = np.random.default_rng(seed)
    turn = pin.Quaternion(rng.normal(size=4)).normalized()
    cell = task.cell.moved(base2=pin.SE3(turn, rng.uniform(0.4, 0.9, 3)))
    middle, half = 0.5 * (cell.lower + cell.upper), 0.5 * (cell.upper - cell.lower)
    placed = dp.Relative(cell, middle + rng.uniform(-0.3, 0.3, cell.n) * half).T_e1_e2
    angle = np.linspace(0.0, 3.0 * np.pi, 40)
    helix = 0.05 * np.column_stack([np.cos(angle) - 1.0, np.sin(angle), 0.1 * angle])
    return dp.Task(cell, dp.Path(placed.translation + helix, placed.rotation))


def starts(problem: Problem, count: int) -> np.ndarray:
    """Return up to `count` minima of the middle point alone, copied to all points (s, k, n)."""
    alone = problem.subset([problem.k // 2], 0.0)
    drawn = common_postures(problem.lower, problem.upper, 1, 20 * count, generator(0, 1))
    minima = distinct(solve_many(alone, drawn)).ends.q[:count]
    return np.repeat(minima, problem.k, axis=1)


def main() -> int:
    """Print one row a task and index, then the gates; return 1 if one failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--only", nargs="*", default=[])
    asked = parser.parse_args()
    share: dict[str, list[bool]] = {name: [] for name in INDICES}
    cost: dict[str, list[float]] = {name: [] for name in INDICES}
    for label, task in tasks(asked.only):
        for name, make in INDICES.items():
            problem = replace(task, index=make()).problem()
            given = starts(problem, asked.starts)
            begun = time.process_time()
            ends = [solve(problem, start) for start in given]
            seconds = time.process_time() - begun
            iterations = sum(end.iterations for end in ends)
            cost[name].append(1e6 * seconds / problem.k / max(iterations, 1))
            share[name] += [end.converged for end in ends]
            print(
                f"{label:13} {name:25} {cost[name][-1]:6.2f} us, "
                f"{iterations / max(len(ends), 1):5.1f} iterations a start, "
                f"{dict(Counter(end.message for end in ends))}",
                flush=True,
            )
    failed = False
    for name in INDICES:
        ratio = float(np.median(np.divide(cost[name], cost["force"])))
        converged = float(np.mean(share[name]))
        bad = bool(ratio > LARGEST_RATIO or converged < np.mean(share["force"]) - SLACK)
        failed |= bad
        print(f"{name:25} {ratio:.2f} times force, {converged:.1%} converged{'  FAILED' * bad}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())

"""Figures of the engine by itself: refinement, warm start, long paths, quick plans, compilation.

Run `python benchmarks/engine.py [--seeds N] [--effort quick|normal]`; everything but the last line
is from a warm cache.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace

import numpy as np

from dualarm_pin.engine.solve import Options, solve
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import distinct
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task import Task

TASK = urdf_folder() / "tasks" / "paper_corner.yaml"
REPEATS = 7


def timed(problem: Problem, start: np.ndarray, **how: object) -> tuple[float, object]:
    """Return the best of several times of one solve [s]."""
    best, outcome = np.inf, None
    for _ in range(REPEATS):
        begun = time.perf_counter()
        outcome = solve(problem, start, **how)  # type: ignore[arg-type]
        best = min(best, time.perf_counter() - begun)
    return best, outcome


def anchors(problem: Problem) -> np.ndarray:
    """Return the minima of the middle point alone, copied to all points (m, k, n)."""
    alone = problem.subset([problem.k // 2], 0.0)
    drawn = common_postures(problem.lower, problem.upper, 1, 200, generator(0, 1))
    minima = distinct(engine.solve_many(alone, drawn)).ends.q[:20]
    return np.repeat(minima, problem.k, axis=1)


def main() -> None:
    """Print every figure with its unit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--effort", choices=("quick", "normal"), default="quick")
    asked = parser.parse_args()
    task = Task.load(TASK)
    problem = task.problem()
    runs = [timed(problem, start) for start in anchors(problem)]
    per = [1e6 * t / problem.k / outcome.iterations for t, outcome in runs]  # type: ignore[attr-defined]
    print(f"refinement from an anchor: median {1e3 * np.median([t for t, _ in runs]):.2f} ms")
    print(f"a point and iteration: median {np.median(per):.2f} us")

    best = plan_global(task, effort="quick", seed=0)
    _, cold = timed(problem, best.q, options=Options(tolerance=1e-9))
    moved = Task.load(TASK, ["cell.arms.arm2.base.xyz=[2.51, 0, 0]"]).problem()
    seconds, warm = timed(moved, cold.q, warm=cold.multipliers)  # type: ignore[attr-defined]
    print(
        f"warm re-solve, base moved by 1 cm: {1e3 * seconds:.2f} ms, {warm.iterations} iterations"  # type: ignore[attr-defined]
    )

    for points in (101, 301, 1001):
        third = (points - 1) // 3
        split = f"path.corner.points=[{third}, {points - 2 * third}, {third}]"
        long = replace(
            Task.load(TASK, [split, "two_stage={}"]), smoothness=3.0 * (points / 31) ** 3
        ).problem()
        seconds, outcome = timed(long, anchors(long)[0])
        iterations = outcome.iterations  # type: ignore[attr-defined]
        print(
            f"{points} points: {1e3 * seconds:.1f} ms a start, {iterations} iterations, "
            f"{1e6 * seconds / points / iterations:.2f} us a point and iteration"
        )

    plans = [plan_global(task, effort=asked.effort, seed=seed) for seed in range(asked.seeds)]
    wall = [plan.timing.wall_s for plan in plans]
    good = sum(plan.found and plan.objective <= 12.7316 for plan in plans)
    print(
        f"{asked.effort}: {good} of {asked.seeds} seeds at 12.7316 or lower, wall median "
        f"{np.median(wall):.3f} s, nine of ten below {np.percentile(wall, 90):.3f} s"
    )

    with tempfile.TemporaryDirectory() as folder:
        code = (
            "from dualarm_pin.engine.jit.compilation import ensure_compiled; "
            "print(ensure_compiled().seconds)"
        )
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        first = subprocess.run(
            [sys.executable, "-c", code],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        print(f"first compilation: {float(first.stdout):.1f} s")


if __name__ == "__main__":
    main()

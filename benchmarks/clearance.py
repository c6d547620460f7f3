"""What keeping the bodies apart costs, on every task and on bases that move together.

    python benchmarks/clearance.py --tasks b01,b02 --seeds 3 --efforts quick,normal,thorough
    python benchmarks/clearance.py --study --efforts normal

The first prints a row a task: objective without clearance and with each effort (worst of the
seeds), seconds of processor beyond the search without it, smallest distance at and between the
points. Fails where `quick` is not verified, takes more than 3 s more, or ends more than 8 % (in
the mean 4 %) above the best. The second tries 7 distances of the bases with and without a box and a
table, at three clearances: what the path forbids is named, the rest has to be found.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from itertools import product

import numpy as np
import pinocchio as pin

import dualarm_pin as dp
from dualarm_pin.clearance import ClearanceRule
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.solvers.interior_point import ensure_compiled

TASKS = [*(f"b{number:02d}" for number in range(1, 13)), "paper_corner_clear"]
REQUIRED = 0.01  # m
MOST_SECONDS, MOST_ABOVE, MOST_MEAN, MOST_STUDY = 3.0, 1.08, 1.04, 1.04  # what is to be reached
BASES = (2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8)  # m between the two bases of the study
CLEARANCES = (0.0, 0.05, 0.15)  # m


def main() -> int:
    """Print a table; return 1 where a figure is not reached."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", default=",".join(TASKS))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--efforts", default="quick,normal,thorough")
    parser.add_argument("--study", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    ensure_compiled(print)
    efforts, seeds = given.efforts.split(","), range(given.seeds)
    if given.study:
        return study(efforts, seeds, given.jobs)
    return tasks(given.tasks.split(","), efforts, seeds, given.jobs)


def tasks(names: list[str], efforts: list[str], seeds: range, jobs: int) -> int:
    """Print a row a task."""
    print("| task | without | " + " | ".join(efforts) + " | s more | at | between | verified |")
    print("|---" * (len(efforts) + 6) + "|")
    failed, above = False, []
    for name in names:
        task = dp.Task.load(urdf_folder() / "tasks" / f"{name}.yaml")
        task = replace(task, clearance=ClearanceRule(REQUIRED, spare_fixed=True))
        asked_of(task)  # meshes are loaded once, whatever is asked
        free, base = _run(replace(task, clearance=None), efforts[0], 0, jobs)
        runs = {effort: [_run(task, effort, seed, jobs) for seed in seeds] for effort in efforts}
        best = (
            min(a.objective for each in runs.values() for a, _ in each if a.found)
            if any(a.found for each in runs.values() for a, _ in each)
            else np.inf
        )
        first = runs[efforts[0]]
        worst = max(a.objective if a.found else np.inf for a, _ in first)
        more = max(seconds for _, seconds in first) - base
        found = sum(a.found for a, _ in first)
        above.append(worst / best)
        failed |= found < len(first) or more > MOST_SECONDS or worst / best > MOST_ABOVE
        cells = [_worst(runs[effort]) for effort in efforts]
        at = min(a.min_clearance for a, _ in first)
        between = min(_between(a) for a, _ in first)
        print(
            f"| {name} | {free.objective:.4f} | {' | '.join(cells)} | {more:.1f} | {at:.4f} | "
            f"{between:.4f} | {found} of {len(first)} |",
            flush=True,
        )
    mean = float(np.mean(above))
    print(f"\nmean of {efforts[0]} to the best: {mean:.4f}")
    return int(failed or not mean <= MOST_MEAN)


def study(efforts: list[str], seeds: range, jobs: int) -> int:
    """Print a row a case of the study."""
    loaded = dp.Task.load(urdf_folder() / "tasks" / "paper_corner_clear.yaml")
    ratios, failed = [], False
    for distance, clearance in product(BASES, CLEARANCES):
        base = pin.SE3(pin.utils.rotate("z", np.pi), np.array([distance, 0.0, 0.0]))
        cell = loaded.cell.moved(base2=base)
        task = replace(loaded, cell=cell, clearance=ClearanceRule(clearance, spare_fixed=True))
        if asked_of(task).forbidden:
            print(f"{distance} {clearance}: {asked_of(task).forbidden[0].text}", flush=True)
            continue
        runs = [_run(task, effort, seed, jobs)[0] for effort in efforts for seed in seeds]
        found = [answer.objective for answer in runs if answer.found]
        failed |= len(found) < len(runs)
        ratios += [value / min(found) for value in found]
        print(f"{distance} {clearance}: {len(found)} of {len(runs)} {sorted(found)}", flush=True)
    mean = float(np.mean(ratios))
    print(f"mean ratio to the best found: {mean:.4f}")
    return int(failed or not mean <= MOST_STUDY)


def _run(task: dp.Task, effort: str, seed: int, jobs: int) -> tuple[dp.Trajectory, float]:
    begun = time.process_time()
    answer = dp.plan_global(task, effort=effort, seed=seed, jobs=jobs)
    return answer, time.process_time() - begun


def _worst(runs: list[tuple[dp.Trajectory, float]]) -> str:
    values = [answer.objective if answer.found else np.inf for answer, _ in runs]
    return f"{max(values):.4f}"


def _between(answer: dp.Trajectory) -> float:
    apart = answer.checked.apart
    least = None if apart is None else apart.least_between
    return np.nan if least is None else least


if __name__ == "__main__":
    sys.exit(main())

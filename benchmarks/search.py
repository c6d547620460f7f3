"""How near each effort comes to the best known path of every task, and what it costs.

    python benchmarks/search.py --effort quick --seeds 5 --tasks b03,b04

Prints one row a task: how many seeds end within 1e-4 of the best known value, how far each ends
above it, and the median of the processor time. Fails if a seed finds better than the table of best
known values (then it is to be raised, with `--raise`), and if a seed of `normal` or `thorough` ends
above it on more than one task.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import dualarm_pin as dp
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.solvers.interior_point import ensure_compiled

TABLE = Path(__file__).with_name("best_known.json")
NEAR = 1e-4
MISSED = 1  # tasks that `normal` may miss
TASKS = ["paper_corner", "circle", *(f"b{number:02d}" for number in range(1, 13))]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the table; return 1 if it has to be raised, or if an effort falls behind it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--effort", default="quick")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=100)
    parser.add_argument("--tasks", default=",".join(TASKS))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--table", type=Path, default=TABLE, help="best known paths, JSON")
    parser.add_argument("--raise", dest="raised", action="store_true")
    given = parser.parse_args(arguments)
    known = json.loads(given.table.read_text(encoding="utf-8"))
    ensure_compiled(print)
    better, missed = False, []
    print("| task | best known | within 1e-4 | above it by seed [%] | processor [s] | verdicts |")
    print("|---|---|---|---|---|---|")
    for name in given.tasks.split(","):
        task = dp.Task.load(urdf_folder() / "tasks" / f"{name}.yaml")
        task = replace(task, clearance=None)  # the table is of paths that may collide
        best, values, seconds, verdicts = known[name]["objective"], [], [], []
        for seed in range(given.first_seed, given.first_seed + given.seeds):
            begun = time.process_time()
            answer = dp.plan_global(task, effort=given.effort, seed=seed, jobs=given.jobs)
            seconds.append(time.process_time() - begun)
            values.append(answer.objective if answer.found else np.inf)
            verdicts.append(answer.evidence.verdict if answer.evidence else "none")
            if values[-1] < known[name]["objective"] * (1.0 - NEAR):
                better = True
                known[name] = entry(answer, f"{given.effort}, seed {seed}")
        above = np.sort(100.0 * (np.array(values) / best - 1.0))
        if np.any(above >= 100.0 * NEAR):
            missed.append(name)
        print(
            f"| {name} | {best:.6f} | {np.sum(above < 100.0 * NEAR)} of {len(above)} | "
            f"{' '.join(f'{value:.2f}' for value in above)} | {np.median(seconds):.2f} | "
            f"{', '.join(f'{v} {verdicts.count(v)}' for v in sorted(set(verdicts)))} |",
            flush=True,
        )
    if better and given.raised:
        given.table.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    behind = given.effort != "quick" and len(missed) > MISSED
    if better:
        print("better than the table was found" + ("" if given.raised else ": use --raise"))
    if behind:
        print(f"{given.effort} falls behind the table on {', '.join(missed)}")
    return int(better or behind)


def entry(answer: dp.Trajectory, how: str) -> dict[str, object]:
    """Return what the table keeps of a path."""
    return {"objective": answer.objective, "how": how, "joints": digest(answer.q)}


def digest(q: np.ndarray) -> str:
    """Return the SHA-256 of joints (k, n) rounded to 1e-6."""
    return hashlib.sha256((np.round(q, 6) + 0.0).tobytes()).hexdigest()


if __name__ == "__main__":
    sys.exit(main())

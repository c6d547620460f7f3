"""What the harness of `bench` costs, and whether it loses rows when it is killed.

    python benchmarks/batch.py [--runs 10000] [--kills 20] [--seconds 0.3]

Prints overhead a run, start of a cluster, throughput of two workers over one, memory of the parent
on many short runs, and counts rows after kills at random moments. Exit code 1 if a row is lost or
doubled or the parent needs 500 MB; times are printed, not judged.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import subprocess
import sys
import tempfile
import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.bench.batch import BatchResult, run_suite
from dualarm_pin.bench.suite import Suite
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.progress import Progress

if TYPE_CHECKING:
    from dualarm_pin.task import Task

TASK = urdf_folder() / "tasks" / "paper_corner.yaml"
MOST_MEGABYTES = 500


def pretend(task: Task, seed: int, busy: float = 0.0) -> Trajectory:
    """Compute for some seconds of processor time and answer; named by the suites below."""
    end = time.process_time() + busy
    while time.process_time() < end:
        pass
    index = np.full(task.path.h, 1.0 + seed)
    return Trajectory(
        q=np.zeros((task.path.h, task.cell.n)),
        joints=task.cell.joint_names,
        arc_length=task.path.arc_length,
        index=index,
        found=True,
        method="pretend",
        solver="pretend",
        objective=float(index.sum()),
        arc_mean_index=float(index.mean()),
        max_position_error=0.0,
        max_rotation_error=0.0,
        max_bound_violation=0.0,
        max_joint_step=0.0,
        seed=seed,
    )


class Clock(Progress):
    """Notes when each stage began."""

    def __init__(self) -> None:
        self.began: dict[str, float] = {}

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin a stage."""
        self.began[text] = time.perf_counter()


def main() -> int:
    """Measure and print; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10_000, help="short runs for the memory")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=0.3, help="a run of the throughput test")
    arguments = parser.parse_args()
    os.environ["PYTHONPATH"] = os.pathsep.join(
        filter(None, (str(Path(__file__).parent), os.environ.get("PYTHONPATH")))
    )
    with tempfile.TemporaryDirectory() as folder:
        return measure(Path(folder), arguments.runs, arguments.kills, arguments.seconds)


def measure(folder: Path, runs: int, kills: int, seconds: float) -> int:
    load = os.getloadavg()[0]
    print(f"load of the machine before: {load:.1f} on {os.cpu_count()} processors")
    start, _, _ = timed(folder / "short", 300, 0.0, 1)
    print(f"start of a local cluster: {start:.2f} s")
    print(f"overhead beside the solve: {1e3 * overhead(folder / 'short'):.1f} ms a run")
    walls = {jobs: timed(folder / f"jobs{jobs}", 200, seconds, jobs)[1] for jobs in (1, 2)}
    print(
        f"200 runs of {seconds:g} s: {walls[1]:.1f} s with one worker, {walls[2]:.1f} s with two: "
        f"{walls[1] / walls[2]:.2f} times the throughput (two bare processes on this machine: "
        f"{bare_scaling():.2f} times)"
    )
    _, wall, _ = timed(folder / "many", runs, 0.0, 2)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{runs} short runs: {wall:.0f} s, the parent needs {peak:.0f} MB at most")
    lost, doubled = kill_at_random(folder / "kills", kills)
    print(f"{kills} kills at random moments: {lost} rows lost, {doubled} doubled")
    return 1 if lost or doubled or peak > MOST_MEGABYTES else 0


def suite(folder: Path, runs: int, busy: float) -> Path:
    folder.mkdir(parents=True)
    method = {"call": "batch:pretend", "options": {"busy": busy}, "name": "pretend"}
    file = folder / "suite.yaml"
    file.write_text(json.dumps({"tasks": [str(TASK)], "methods": [method], "seeds": runs}))
    return file


def timed(folder: Path, runs: int, busy: float, jobs: int) -> tuple[float, float, BatchResult]:
    """Return seconds to start the workers, seconds of all runs, and the batch."""
    asked = Suite.load(suite(folder, runs, busy), allow_code=True)
    clock = Clock()
    batch = run_suite(asked, folder / "out", jobs=jobs, progress=clock)
    began = clock.began
    return (
        began["runs"] - began["starting workers"],
        began["writing the tables"] - began["runs"],
        batch,
    )


def bare_scaling(seconds: float = 10.0) -> float:
    """Return the throughput of two busy processes over one: what the machine has to give now."""
    code = (
        f"import time\nend = time.process_time() + {seconds}\nwhile time.process_time() < end: pass"
    )
    walls = []
    for count in (1, 2):
        begun = time.perf_counter()
        busy = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(count)]
        for process in busy:
            process.wait()
        walls.append(time.perf_counter() - begun)
    return 2.0 * walls[0] / walls[1]


def overhead(folder: Path) -> float:
    """Return the seconds between two runs of one worker, beside the runs themselves."""
    rows = [json.loads(line) for line in (folder / "out" / "rows.jsonl").read_bytes().splitlines()]
    begun = sorted(datetime.fromisoformat(row["started"]).timestamp() for row in rows)
    solve = sum(row["run_s"] for row in rows[:-1])
    return (begun[-1] - begun[0] - solve) / (len(rows) - 1)


def kill_at_random(folder: Path, kills: int) -> tuple[int, int]:
    """Kill a whole batch at random moments and continue it; return rows lost and doubled."""
    runs = 15 * kills
    file = suite(folder, runs, 0.05)
    log = folder / "out" / "rows.jsonl"
    command = [sys.executable, "-m", "dualarm_pin", "bench", "--allow-code", str(file)]
    command += ["--out", str(folder / "out"), "--jobs", "2", "--resume"]
    chance = random.Random(0)
    lost, before = 0, set()
    for _ in range(kills):
        running = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        time.sleep(chance.uniform(0.5, 6.0))
        running.kill()
        running.wait()
        seen = keys(log)
        lost += len(before - set(seen))
        before = set(seen)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    seen = keys(log)
    return lost + runs - len(set(seen)), len(seen) - len(set(seen))


def keys(log: Path) -> list[str]:
    """Return the keys of all whole lines."""
    if not log.exists():
        return []
    lines = log.read_bytes().split(b"\n")[:-1]
    return [json.loads(line)["key"] for line in lines]


if __name__ == "__main__":
    sys.exit(main())

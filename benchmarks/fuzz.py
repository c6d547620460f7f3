"""Feed broken files of every kind to the program, each within a limit of time and of memory.

    python benchmarks/fuzz.py --cases 20000     # about ten minutes of processor time
    python benchmarks/fuzz.py --only result:17  # one case again, with its traceback

A case passes when the program works with the files or refuses them with a message of its own.
Every other exception, a process that dies, and a limit that is passed are failures. Cases run in
forked processes that hold the loaded package; one that hangs or dies takes only its case along.
"""

from __future__ import annotations

import argparse
import io
import json
import multiprocessing as mp
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import mutations
import sound_files

from dualarm_pin.answer.evidence import Bound, Evidence, LawCount, LocalCheck
from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.answer.notes import GlobalNotes
from dualarm_pin.answer.verify import verified
from dualarm_pin.bench import batch
from dualarm_pin.bench.batch import LOG, run_suite
from dualarm_pin.bench.log.rows import RowLog
from dualarm_pin.bench.report.page import write_report
from dualarm_pin.bench.suite import Suite
from dualarm_pin.bench.work.one_run import perform
from dualarm_pin.cell import Cell
from dualarm_pin.cli.view import view
from dualarm_pin.design.server import Pages
from dualarm_pin.errors import DualArmError, InputError
from dualarm_pin.evidence.sensitivity import cell_costs
from dualarm_pin.exports import export
from dualarm_pin.inspection import inspect
from dualarm_pin.motion.make import make_motion
from dualarm_pin.planners.earlier import resampled
from dualarm_pin.planners.methods import plan
from dualarm_pin.relative import Relative
from dualarm_pin.show.sensitivity import save_costs
from dualarm_pin.task import Task

PAGES: list[Pages] = []
"""The pages of a design server, made once: forked processes have them as they were."""
SECONDS = 10.0  # of processor time of one case
BLOCKED = 60.0  # wall time of one case: only what waits for ever takes so long
MEMORY = 2 * 1024**3  # bytes of address space beyond what the process begins with
AGAIN = 500  # cases after which a process gives way to a fresh one
MOST_VERIFIED = 200  # points; longer paths are loaded and not checked
LOCAL = LocalCheck(12.7, 1e-12, 1e-9, 0.01, 98, 0.28, 88, 0.2, 0.2, 1.0, 0, {"arm1/elbow": 2.0})
BOUND = Bound(12.6, 12.7, (2,), (4, 4), (2, 2), 5.0, {(2,): 12.6})
LAW = LawCount(300, 280, 46, 9, 3, 1, 12.9, 4)
EVIDENCE = Evidence(
    "best_known_bounded", {"anchored": LAW}, missed_share_95=0.005, laws_agree=True,
    stopping_rule="enough", stopping_rule_met=True, local=LOCAL, bound=BOUND,
    sentences="Best of\n 9 starts.",
)  # fmt: skip


def middle(task: Task) -> np.ndarray:
    """Return the middle of the bounds at each point (h, n)."""
    return np.tile((task.cell.lower + task.cell.upper) / 2, (task.path.h, 1))


def use_cell(cell: Cell) -> None:
    """Ask a cell what every command asks of it."""
    q = (cell.lower + cell.upper) / 2
    at = Relative(cell, q)
    assert np.isfinite(at.J_r).all(), "J_r is not finite"
    clearance = cell.clearance(q)
    assert clearance is None or np.isfinite(clearance.distance), "the clearance is not finite"


def use_task(task: Task) -> None:
    """Make the problem of a task and check an answer to it."""
    use_cell(task.cell)
    task.as_yaml()
    if task.path.h <= MOST_VERIFIED:
        task.problem()
        verified(task, middle(task), method="global", solver="engine")


def run(kind: str, folder: Path) -> None:
    """Give the broken files to the program, as the commands do."""
    if kind in ("cell", "robot", "mesh"):
        use_cell(Cell.load(folder / "cell.yaml"))
        if kind == "mesh":
            inspect(folder / "cell.yaml").draw(folder / "cell.html")
    elif kind in ("task", "number", "path"):
        use_task(Task.load(folder / "task.yaml"))
    elif kind == "suite":
        Suite.load(folder / "suite.yaml")
    elif kind == "result":
        view((folder / "result",), html=folder / "page.html")
    elif kind == "motion":
        view((folder / "moving",), html=folder / "page.html")
        task, trajectory = load_result(folder / "moving")
        resampled(task, trajectory)
    elif kind == "export":
        export(folder / "moving", (folder / "to").read_text(), folder / "program")
    elif kind == "batch":
        use_rows(folder)
    else:
        use_requests((folder / "requests").read_bytes())


def use_rows(folder: Path) -> None:
    """Continue a batch of which nothing is missing, as `bench --resume` does, and report it."""
    suite = Suite.load(folder / "few.yaml")
    write_report(suite, run_suite(suite, folder / "batch", resume=True), "dualarm-pin bench")


def use_requests(bodies: bytes) -> None:
    """Answer requests as the server of a design page does, each after the other."""
    for body in bodies.splitlines():
        refused = []
        for answer in PAGES[0].talk.answers.values():
            try:
                answer(body)
            except DualArmError as error:
                refused.append(error)
        if len(refused) == len(PAGES[0].talk.answers):
            raise refused[0]


def prepare(folder: Path) -> None:
    """Write the sound files, and sound results of them."""
    sound_files.sound(folder)
    task = Task.load(folder / "task.yaml")
    answer = verified(
        task, middle(task), method="global", solver="engine", seed=0, evidence=EVIDENCE,
        notes=GlobalNotes("quick", False),
    )  # fmt: skip
    save_result(folder / "result", task, answer)
    prepare_motion(folder)
    prepare_batch(folder)


def prepare_motion(folder: Path) -> None:
    """Write a task that can be met, and a result of it with a motion, an alternative and costs."""
    cell = Cell.load(folder / "cell.yaml")
    middle = Relative(cell, (cell.lower + cell.upper) / 2).T_e1_e2.translation
    ends = [middle.tolist(), (middle + np.array([0.01, 0.0, 0.01])).tolist()]
    path = {"polyline": {"vertices": ends, "points": 5}, "free": "rotation"}
    (folder / "easy.yaml").write_text(json.dumps(sound_files.EASY | {"path": path}))
    task = Task.load(folder / "easy.yaml")
    answer = plan(task, "local")
    for place in ("moving", "moving/alternatives/2"):
        save_result(folder / place, task, answer)
    make_motion(task, answer).write(folder / "moving")
    save_costs(folder / "moving", cell_costs(task, answer.q))
    PAGES[:] = [Pages(task, folder / "saved", jobs=1)]
    for page in range(2):
        PAGES[0].open()
        PAGES[0]._pages[page].desk._search = lambda: None


def prepare_batch(folder: Path) -> None:
    """Write the rows of a finished batch."""
    (folder / "few.yaml").write_text(json.dumps(sound_files.FEW))
    with RowLog(folder / "batch" / LOG) as log:
        for run in Suite.load(folder / "few.yaml").runs:
            log.append([perform(run, keep=False).row(run)])


def never(runs: Any, *_: Any) -> None:
    """Stand for the workers of a batch, which would take the time of many cases."""
    raise InputError(f"{len(runs)} runs are missing")


def sound_files_work(folder: Path) -> None:
    """Fail if a sound file is refused: then its mutations would prove little."""
    (folder / "to").write_text("ros2")
    (folder / "requests").write_text("\n".join(map(json.dumps, sound_files.REQUESTS)))
    for kind in mutations.KINDS:
        run(kind, folder)
    for cell in sound_files.CELLS:
        (folder / "sound.yaml").write_text(json.dumps(cell))
        use_cell(Cell.load(folder / "sound.yaml"))
    first = {"path": sound_files.PATHS[0]}
    sections = [{"path": path} for path in sound_files.PATHS]
    sections += [first | {"index": index} for index in sound_files.INDICES]
    sections += [first | section for section in sound_files.SECTIONS]
    for section in sections:
        (folder / "sound.yaml").write_text(json.dumps(sound_files.TASK | section))
        why = [said for part, said in sound_files.REFUSED.items() if part in json.dumps(section)]
        try:
            use_task(Task.load(folder / "sound.yaml"))
        except DualArmError as error:
            if not any(said in str(error) for said in why):
                raise


def outcome(kind: str, seed: int, sound: Path) -> tuple[str, str]:
    """Run a case in this process: `works`, `refused` or `failed`, and the message."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
        folder = Path(name) / "case"
        shutil.copytree(sound, folder)
        mutations.make(kind, seed, folder)
        try:
            run(kind, folder)
        except DualArmError as error:
            message = str(error)
            message.encode()  # a terminal must be able to print it
            return "refused", message[:300]
        except BaseException as error:
            where = traceback.extract_tb(error.__traceback__)
            ours = [f for f in where if "dualarm_pin/" in f.filename] or where
            place = f"{Path(ours[-1].filename).name}:{ours[-1].lineno}"
            return "failed", f"{place} {type(error).__name__}: {str(error)[:200]!r}"
    return "works", ""


def work(cases: list[tuple[str, int]], sound: Path, pipe: Connection) -> None:
    """Run cases one after the other; tell which one begins and how it ended."""
    batch._run = never
    sys.stdout = io.StringIO()
    most = MEMORY + _address_space()
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for kind, seed in cases:
        pipe.send(("begins", kind, seed, ""))
        signal.setitimer(signal.ITIMER_PROF, SECONDS)  # ends the process
        try:
            status, message = outcome(kind, seed, sound)
        except UnicodeEncodeError as error:
            status, message = "failed", f"a message cannot be printed: {error}"
        pipe.send((status, kind, seed, message))


def _address_space() -> int:
    """Return the bytes that this process has mapped: libraries reserve more than they use."""
    file = Path("/proc/self/statm")
    return int(file.read_text().split()[0]) * resource.getpagesize() if file.exists() else MEMORY


class Worker:
    """A forked process with its cases; `left` are those that have not ended."""

    def __init__(self, cases: list[tuple[str, int]], sound: Path) -> None:
        self.left = cases
        self.gone = False
        self.pipe, other = mp.Pipe(duplex=False)
        self.process = mp.get_context("fork").Process(target=work, args=(cases, sound, other))
        self.process.start()
        other.close()
        self.since = time.monotonic()

    def ended(self) -> list[tuple[str, str, int, str]]:
        """Return the cases that ended since; a process that died or hangs fails its case."""
        found = []
        try:
            while self.left and self.pipe.poll():
                status, kind, seed, message = self.pipe.recv()
                self.since = time.monotonic()
                if status != "begins":
                    self.left = self.left[1:]
                    found.append((status, kind, seed, message))
        except EOFError:
            self.process.join()
            self.gone = True
            found.append(("failed", *self.left[0], _death(self.process.exitcode)))
            self.left = self.left[1:]
        if self.left and not self.gone and time.monotonic() - self.since > BLOCKED:
            self.gone = True
            found.append(("failed", *self.left[0], f"waited longer than {BLOCKED:g} s"))
            self.left = self.left[1:]
        if self.gone or not self.left:
            self.gone = True
            self.process.kill()
            self.process.join()
            self.pipe.close()
        return found


def fuzz(cases: list[tuple[str, int]], jobs: int, sound: Path) -> list[tuple[str, str, int, str]]:
    """Run all cases in so many processes and return how each ended."""
    found: list[tuple[str, str, int, str]] = []
    waiting = [cases[k : k + AGAIN] for k in range(0, len(cases), AGAIN)]
    workers: list[Worker] = []
    while waiting or workers:
        while waiting and len(workers) < jobs:
            workers.append(Worker(waiting.pop(0), sound))
        wait([worker.pipe for worker in workers], timeout=0.2)
        for worker in list(workers):
            for ended in worker.ended():
                found.append(ended)
                if ended[0] == "failed":
                    print(f"FAILED {ended[1]}:{ended[2]} {ended[3]}", flush=True)
            if worker.gone:
                workers.remove(worker)
                print(f"{len(found)} of {len(cases)}", file=sys.stderr, flush=True)
                waiting += [worker.left] if worker.left else []
    return found


def _death(code: int | None) -> str:
    if code == -signal.SIGPROF:
        return f"took more than {SECONDS:g} s of processor time"
    return f"the process died with {code}"


def main() -> int:
    """Run the cases that the command line asks for; 1 if any failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=20_000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first case")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", default=list(mutations.KINDS))
    parser.add_argument("--only", help="KIND:SEED, in this process")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fuzz-sound-") as name:
        sound = Path(name)
        prepare(sound)
        if asked.only:
            kind, seed = asked.only.split(":")
            mutations.make(kind, int(seed), sound)
            run(kind, sound)
            return 0
        sound_files_work(sound)
        kinds: Any = asked.kinds
        seeds = range(asked.first, asked.first + asked.cases)
        begun = time.monotonic()
        found = fuzz([(kinds[k % len(kinds)], k) for k in seeds], asked.jobs, sound)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    counts = Counter((kind, status) for status, kind, *_ in found)
    for kind in kinds:
        print(f"{kind:8}" + "".join(
            f"{counts[kind, status]:7} {status}" for status in ("works", "refused", "failed")
        ))  # fmt: skip
    failed = sum(status == "failed" for status, *_ in found)
    print(
        f"{len(found)} cases, {failed} failed; {spent.ru_utime + spent.ru_stime:.0f} s of "
        f"processor time, {time.monotonic() - begun:.0f} s; largest process "
        f"{spent.ru_maxrss / 2**20:.2f} GB"
    )
    return 1 if failed or len(found) != asked.cases else 0


if __name__ == "__main__":
    sys.exit(main())

"""Run a suite into a folder: log, trajectories, tables, report, gates."""

from __future__ import annotations

import importlib.util
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from dualarm_pin.bench.columns import Row, brief, first_wrong, of_run
from dualarm_pin.bench.gates import Gate
from dualarm_pin.bench.kept_trajectories import Keeper
from dualarm_pin.bench.log.rows import RowLog
from dualarm_pin.bench.log.table import write_tables
from dualarm_pin.bench.log.writer import Writer
from dualarm_pin.bench.run import BenchRun
from dualarm_pin.bench.suite import Suite
from dualarm_pin.bench.work import cluster
from dualarm_pin.bench.work.dispatch import Ended, run_on_workers
from dualarm_pin.errors import InputError, MissingExtraError
from dualarm_pin.progress import SILENT, Progress

LOG = "rows.jsonl"


@dataclass(frozen=True)
class BatchResult:
    """A finished batch.

    Attributes:
        folder: Where it is.
        rows: One brief row a run, flat, in the order of the suite.
        done_before: How many of them an earlier session had done.
        gates: Every gate, and why it does not hold (None: it does).
    """

    folder: Path
    rows: tuple[Row, ...]
    done_before: int
    gates: tuple[tuple[Gate, str | None], ...]

    @property
    def passed(self) -> bool:
        """Whether every gate holds."""
        return all(failure is None for _, failure in self.gates)

    @property
    def counts(self) -> Counter[str]:
        """How many runs ended in which way."""
        return Counter(row["status"] for row in self.rows)


def run_suite(
    suite: Suite,
    folder: Path,
    *,
    jobs: int | None = None,
    address: str | None = None,
    resume: bool = False,
    progress: Progress = SILENT,
) -> BatchResult:
    """Run what is missing of a suite and write its tables.

    In a script of your own, call it below `if __name__ == "__main__":`, since local workers are
    processes that import the script.

    Args:
        suite: The suite.
        folder: Where rows, trajectories and tables go.
        jobs: Local worker processes; None takes the processors there are.
        address: A dask scheduler to use instead.
        resume: Continue a folder; without it one with content is refused.
        progress: Told where the work stands.

    Raises:
        InputError: The folder is in use or cannot be written, or there is no such scheduler.
        MissingExtraError: dask.distributed or pyarrow is not installed.
        DualArmError: The scheduler was lost.
    """
    if not resume and folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(
            "there is something here: add --resume to continue it, or give another --out",
            file=folder,
        )
    for library in ("distributed", "pyarrow"):
        if importlib.util.find_spec(library) is None:  # before the first run, not after the last
            raise MissingExtraError(
                f"batches need {library}, which is not installed: pip install 'dualarm-pin[bench]'"
            )
    runs = {run.key: run for run in suite.runs}
    keeper = Keeper(folder, suite.spec.keep, {key: i for i, key in enumerate(runs)})
    with RowLog(folder / LOG) as log:
        missing = [run for key, run in runs.items() if key not in log]
        done_before = len(runs) - len(missing)
        if len(log) > done_before:
            progress.line(
                f"{len(log) - done_before} rows in {folder} are not of this suite: they stay in "
                f"{LOG} and are left out of the tables"
            )
        keeper.recall(_relabelled(log, runs, [key for key in runs if key in log]))
        if missing:
            _run(missing, log, keeper, jobs, address, progress)
        progress.stage("writing the tables")
        read = partial(_relabelled, log, runs, list(runs))
        write_tables(folder, read)
        rows = tuple(brief(row) for row in read())
    gates = tuple((gate, gate.failure(rows)) for gate in suite.gates)
    return BatchResult(folder, rows, done_before, gates)


def _run(
    runs: list[BenchRun],
    log: RowLog,
    keeper: Keeper,
    jobs: int | None,
    address: str | None,
    progress: Progress,
) -> None:
    def written(ended: Sequence[Ended]) -> None:
        for run, outcome in ended:
            if outcome.status != "ok":
                name = f"{run.method.name} on {' '.join(filter(None, run.problem))}"
                progress.line(f"{outcome.status}: {name}, seed {run.seed}: {outcome.reason}")
        progress.advance(len(ended))

    progress.stage("starting workers")
    with cluster.workers(jobs, address) as client, Writer(log, keeper, written) as writer:
        progress.stage("runs", len(runs))
        no_worker = partial(progress.line, "no worker is left: waiting for one to come")
        for ended in run_on_workers(client, runs, keeper.keep != "none", no_worker):
            writer.put(ended)


def _relabelled(log: RowLog, runs: dict[str, BenchRun], keys: list[str]) -> Iterator[Row]:
    """Read rows, each with what the suite says of its run today, as the names of its task."""
    for key, row in zip(keys, log.rows(keys), strict=True):
        row |= of_run(runs[key])
        if (field := first_wrong(row)) is not None:
            raise log.refusal(key, field)
        yield row

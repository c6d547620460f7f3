"""Spread runs over the workers of a `distributed.Client`, a few ahead of those that end."""

from __future__ import annotations

import itertools
import queue
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from typing import Any

from dualarm_pin.bench.run import BenchRun, RunOutcome
from dualarm_pin.bench.work.runner import DEATHS, run_watched
from dualarm_pin.errors import DualArmError

Ended = tuple[BenchRun, RunOutcome]
_KILLER = RunOutcome("crashed", f"it was alone on {DEATHS} worker processes that died")
_PATIENCE = 20.0  # seconds without an end before the workers are counted
_RECOUNT = 1.0  # seconds between two counts of the workers
_AGAIN = ("pending", "lost")  # it had ended, but its worker died with the result: it is done again
_AHEAD = 4  # runs in flight for each worker thread: none waits for the parent


def run_on_workers(
    client: Any,
    runs: Iterable[BenchRun],
    keep: bool,
    waiting: Callable[[], None] = lambda: None,
) -> Iterator[list[Ended]]:
    """Do runs on the workers; yield those that ended, in the order in which they end.

    Only a few runs for each worker are in flight, so that a long batch costs the parent no more
    memory than a short one. A run whose worker process dies is done again elsewhere. One that was
    on two workers that died is set aside until the others are done, since it may just have stood
    beside the culprit; alone, and killing again, it is an outcome.

    Args:
        client: A `distributed.Client`.
        runs: The runs.
        keep: Return trajectories too.
        waiting: Called while there is no worker.

    Raises:
        DualArmError: The scheduler was lost.
    """
    rest = iter(runs)
    flying: dict[Any, BenchRun] = {}
    suspects: list[BenchRun] = []
    ended: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def submit(run: BenchRun, mark: str) -> Any:
        future = client.submit(run_watched, run, keep, key=f"{mark}-{run.key}", pure=False)
        future.add_done_callback(ended.put)
        return future

    def send(count: int) -> None:
        for run in itertools.islice(rest, max(count, 0)):
            flying[submit(run, "run")] = run

    room, counted = _room(client), time.monotonic()
    send(room)
    while flying:
        futures = _next(ended, client, waiting)
        outcomes = _outcomes(client, futures)
        batch: list[Ended] = []
        for future, outcome in zip(futures, outcomes, strict=True):
            run = flying.pop(future)
            if outcome is None:
                suspects.append(run)
            else:
                batch.append((run, outcome))
            future.release()
        if time.monotonic() > counted + _RECOUNT:
            room, counted = _room(client), time.monotonic()
        send(room - len(flying))
        yield batch
    for run in suspects:
        future = submit(run, "run-alone")
        _next(ended, client, waiting)
        yield [(run, _outcomes(client, [future])[0] or _KILLER)]


def _next(ended: queue.SimpleQueue[Any], client: Any, waiting: Callable[[], None]) -> list[Any]:
    """Wait for a future and return all that ended by then."""
    futures: list[Any] = []
    while not futures:
        try:
            futures.append(ended.get(timeout=_PATIENCE))
        except queue.Empty:
            if not client.nthreads():
                waiting()
    while not ended.empty():
        futures.append(ended.get())
    return futures


def _room(client: Any) -> int:
    """Return how many runs may be in flight."""
    threads: int = sum(client.nthreads().values())
    return max(1, threads) * _AHEAD


def _outcomes(client: Any, futures: Sequence[Any]) -> list[RunOutcome | None]:
    """Return what came of runs that ended, None for one whose workers died.

    Raises:
        DualArmError: The scheduler was lost, or a worker cannot do runs.
    """
    from distributed import KilledWorker

    for future in futures:
        if future.status in _AGAIN:
            with suppress(KilledWorker, CancelledError):
                future.result()
    finished = [future for future in futures if future.status == "finished"]
    results: dict[Any, RunOutcome] = {}
    try:  # together, which is faster
        results = dict(zip(finished, client.gather(finished, direct=True), strict=True))
    except KilledWorker:  # a worker died with its result, and the run done again killed others
        for future in finished:
            with suppress(KilledWorker):
                results[future] = future.result()
    for future in futures:
        if future in results:
            continue
        if future.status != "error":
            raise DualArmError(
                "the scheduler was lost; what ended is on disk: continue with --resume"
            )
        error = future.exception()
        if not isinstance(error, KilledWorker):
            raise DualArmError(
                f"a worker could not do a run: {type(error).__name__}: {error}; what ended is on "
                "disk: continue with --resume"
            ) from error
    return [results.get(future) for future in futures]

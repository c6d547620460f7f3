"""Spread runs over workers with dask.distributed: local processes, or a scheduler that exists."""

from __future__ import annotations

import itertools
import logging
import queue
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

from dualarm_pin import __version__
from dualarm_pin.bench.run import Outcome, Run
from dualarm_pin.bench.runner import DEATHS, run_watched
from dualarm_pin.errors import DualArmError, InputError, MissingExtraError

CONNECT = 30.0  # seconds to reach a scheduler and its first worker
_PATIENCE = 20.0  # seconds without an end before the workers are counted
_RECOUNT = 1.0  # seconds between two counts of the workers
_AHEAD = 4  # runs in flight for each worker thread: none waits for the parent
Ended = tuple[Run, Outcome]


@contextmanager
def workers(jobs: int | None, address: str | None) -> Iterator[Any]:
    """Give a `distributed.Client` with workers; a local cluster ends with the block.

    Args:
        jobs: Number of local processes; None takes the processors there are.
        address: A scheduler that exists, such as `tcp://10.0.0.1:8786`, instead of a local one.

    Raises:
        MissingExtraError: dask.distributed is not installed.
        InputError: The scheduler or its workers cannot be reached, or have another version.
    """
    try:
        import dask
        import distributed as dd
    except ImportError as error:
        raise MissingExtraError(
            "batches need dask.distributed and pyarrow: pip install 'dualarm-pin[bench]'"
        ) from error
    settings = {
        "distributed.scheduler.allowed-failures": DEATHS - 1,
        "distributed.comm.timeouts.connect": CONNECT,
        "distributed.admin.low-level-log-length": 100,
    }
    distributed: Any = dd  # its functions have no annotations
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        if address is None:
            scratch = stack.enter_context(
                tempfile.TemporaryDirectory(prefix="dualarm-pin-", ignore_cleanup_errors=True)
            )
            cluster = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=jobs or _processors(),
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",  # None would take port 8787 all the same
                    scheduler_kwargs={"dashboard": False},
                    memory_limit=0,  # the runs are in processes of their own
                    local_directory=scratch,
                    silence_logs=logging.CRITICAL,
                    preload=["dualarm_pin.bench.preload"],
                )
            )
            yield stack.enter_context(distributed.Client(cluster, set_as_default=False))
            return
        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        try:
            client = stack.enter_context(
                distributed.Client(address, timeout=CONNECT, set_as_default=False)
            )
        except (OSError, TimeoutError, ValueError) as error:
            raise InputError(
                f"no scheduler answers at {address!r}: start one with `dask scheduler`",
                field="--cluster",
            ) from error
        _probe(client, address)
        yield client


def spread(
    client: Any,
    runs: Iterable[Run],
    keep: bool,
    waiting: Callable[[], None] = lambda: None,
) -> Iterator[list[Ended]]:
    """Do runs on the workers; yield those that ended, in the order in which they end.

    Only a few runs for each worker are in flight, so that a long batch costs the parent no more
    memory than a short one. A run whose worker process dies is done again elsewhere; one that
    takes two workers with it is an outcome.

    Args:
        client: A `distributed.Client`.
        runs: The runs.
        keep: Return trajectories too.
        waiting: Called while there is no worker.

    Raises:
        DualArmError: The scheduler was lost.
    """
    rest = iter(runs)
    flying: dict[Any, Run] = {}
    ended: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def send(count: int) -> None:
        for run in itertools.islice(rest, max(count, 0)):
            future = client.submit(run_watched, run, keep, key=f"run-{run.key}", pure=False)
            flying[future] = run
            future.add_done_callback(ended.put)

    room, counted = _room(client), time.monotonic()
    send(room)
    while flying:
        futures = _next(ended, client, waiting)
        outcomes = _outcomes(client, futures)
        batch = [(flying.pop(f), outcome) for f, outcome in zip(futures, outcomes, strict=True)]
        for future in futures:
            future.release()
        if time.monotonic() > counted + _RECOUNT:
            room, counted = _room(client), time.monotonic()
        send(room - len(flying))
        yield batch


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


def _outcomes(client: Any, futures: Sequence[Any]) -> list[Outcome]:
    """Return what came of runs that ended; the results are fetched together."""
    finished = [future for future in futures if future.status == "finished"]
    results = dict(zip(finished, client.gather(finished, direct=True), strict=True))
    return [results[f] if f in results else _lost(f) for f in futures]


def _lost(future: Any) -> Outcome:
    """Return the outcome of a run that took its workers along."""
    from distributed import KilledWorker

    if future.status != "error":
        raise DualArmError("the scheduler was lost; what ended is on disk: continue with --resume")
    error = future.exception()
    if isinstance(error, KilledWorker):
        return Outcome("crashed", f"{DEATHS} worker processes died while they did it")
    raise DualArmError(
        f"a worker could not do a run: {type(error).__name__}: {error}; what ended is on disk: "
        "continue with --resume"
    ) from error


def _probe(client: Any, address: str) -> None:
    """Refuse workers that would fail every run."""
    try:
        client.wait_for_workers(1, timeout=CONNECT)
    except TimeoutError as error:
        raise InputError(
            f"the scheduler at {address!r} has no worker: start some with `dask worker {address}`",
            field="--cluster",
        ) from error
    try:
        found = client.run(_version)
    except Exception as error:
        raise InputError(
            f"a worker of {address!r} cannot import dualarm_pin: install it there ({error})",
            field="--cluster",
        ) from error
    for worker, version in found.items():
        if version != __version__:
            raise InputError(
                f"worker {worker} has dualarm-pin {version}, this is {__version__}: install the "
                "same version everywhere",
                field="--cluster",
            )


def _version() -> str:
    from dualarm_pin import __version__ as version

    return version


def _processors() -> int:
    from dualarm_pin.multistart.workers import available_processors

    return available_processors()

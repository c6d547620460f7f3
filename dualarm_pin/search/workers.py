"""Workers: processes that run starts of solvers which hold Python's lock.

The starts are drawn before any task exists and the results come back in their order, so the
answer does not depend on the number of workers.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from dualarm_pin.errors import WorkerError

Result = TypeVar("Result")

_THREAD_LIMITS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


class Workers:
    """A pool of processes, started when it is first needed.

    Use as a context manager; one pool serves all stages of a planner. Ctrl-C stops the work: what
    is finished is kept, and `interrupted` tells. `cpu_s` sums the processor time of the processes.

    Args:
        jobs: Number of processes; 1 runs in this process, None takes the processors there are.
    """

    def __init__(self, jobs: int | None = None) -> None:
        self.jobs = available_processors() if jobs is None else max(1, jobs)
        self.interrupted = False
        self.cpu_s = 0.0
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def run(
        self,
        function: Callable[..., Result],
        calls: Sequence[tuple[Any, ...]],
        done: Callable[[int], None] = lambda count: None,
    ) -> list[Result | None]:
        """Call `function` with every tuple of arguments; return the results in their order.

        Args:
            function: A function of a module, so that it can be sent to a process.
            calls: Its arguments, one tuple a call.
            done: Told how many calls ended, as they end.

        Returns:
            A result a call, None for those that Ctrl-C cut off.

        Raises:
            WorkerError: A process died.
        """
        results: list[Result | None] = [None] * len(calls)
        if self.interrupted or not calls:
            return results
        try:
            ended = self._here if self._stay_here(function, calls) else self._in_pool
            for position, result in ended(function, calls):
                results[position] = result
                done(1)
        except KeyboardInterrupt:
            self.interrupted = True
            self.close()
        except BrokenProcessPool as error:
            self.close()
            raise WorkerError(
                "a worker process died. A script that plans with several processes must do so "
                "under `if __name__ == '__main__':`, because each process reads the script anew; "
                "or give jobs=1"
            ) from error
        return results

    def close(self) -> None:
        """End the processes."""
        if self._pool is not None:
            processes = list((self._pool._processes or {}).values())
            self._pool.shutdown(wait=not self.interrupted, cancel_futures=True)
            if self.interrupted:
                for process in processes:
                    process.terminate()
            self._pool = None

    def _stay_here(self, function: Callable[..., Result], calls: Sequence[tuple[Any, ...]]) -> bool:
        if self.jobs == 1 or len(calls) == 1:
            return True
        try:  # an index of the user's own, made on the spot, cannot be sent to a process
            pickle.dumps((function, calls[0]))
        except (pickle.PicklingError, AttributeError, TypeError):
            return True
        return False

    def _here(
        self, function: Callable[..., Result], calls: Sequence[tuple[Any, ...]]
    ) -> Iterator[tuple[int, Result]]:
        for position, arguments in enumerate(calls):
            yield position, function(*arguments)

    def _in_pool(
        self, function: Callable[..., Result], calls: Sequence[tuple[Any, ...]]
    ) -> Iterator[tuple[int, Result]]:
        if self._pool is None:
            for name in _THREAD_LIMITS:  # read when a child first imports numpy
                os.environ.setdefault(name, "1")
            self._pool = ProcessPoolExecutor(
                self.jobs, multiprocessing.get_context("spawn"), _leave_ctrl_c_to_the_parent
            )
        futures: dict[Future[tuple[Result, float]], int] = {
            self._pool.submit(_timed, function, arguments): position
            for position, arguments in enumerate(calls)
        }
        for future in as_completed(futures):
            result, cpu_s = future.result()
            self.cpu_s += cpu_s
            yield futures[future], result


def _timed(function: Callable[..., Result], arguments: tuple[Any, ...]) -> tuple[Result, float]:
    begun = time.process_time()
    return function(*arguments), time.process_time() - begun


def available_processors() -> int:
    """Return how many processors this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS
        return os.cpu_count() or 1


def _leave_ctrl_c_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)

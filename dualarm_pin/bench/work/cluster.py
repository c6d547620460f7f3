"""Workers of dask.distributed: processes of this machine, or a scheduler that exists."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from dualarm_pin import __version__
from dualarm_pin.bench.work.runner import DEATHS
from dualarm_pin.errors import InputError

CONNECT = 30.0  # seconds to reach a scheduler and its first worker


@contextmanager
def workers(jobs: int | None, address: str | None) -> Iterator[Any]:
    """Give a `distributed.Client` with workers; a local cluster ends with the block.

    Args:
        jobs: Number of local processes; None takes the processors there are.
        address: A scheduler that exists, such as `tcp://10.0.0.1:8786`, instead of a local one.

    Raises:
        InputError: The scheduler or its workers cannot be reached, or have another version.
    """
    import dask
    import distributed as dd

    from dualarm_pin.search.workers import available_processors

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
                    n_workers=jobs or available_processors(),
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",  # None would take port 8787 all the same
                    scheduler_kwargs={"dashboard": False},
                    memory_limit=0,  # the runs are in processes of their own
                    local_directory=scratch,
                    silence_logs=logging.CRITICAL,
                    preload=["dualarm_pin.bench.work.runner"],
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
            raise _refused(
                f"no scheduler answers at {address!r}: start one with `dask scheduler`"
            ) from error
        _probe(client, address)
        yield client


def _probe(client: Any, address: str) -> None:
    """Refuse workers that would fail every run."""
    try:
        client.wait_for_workers(1, timeout=CONNECT)
    except TimeoutError as error:
        raise _refused(
            f"the scheduler at {address!r} has no worker: start some with `dask worker {address}`"
        ) from error
    try:
        found = client.run(_version)
    except Exception as error:
        raise _refused(
            f"a worker of {address!r} cannot import dualarm_pin: install it there ({error})"
        ) from error
    for worker, version in found.items():
        if version != __version__:
            raise _refused(
                f"worker {worker} has dualarm-pin {version}, this is {__version__}: install the "
                "same version everywhere"
            )


def _refused(message: str) -> InputError:
    return InputError(message, field="--cluster")


def _version() -> str:
    from dualarm_pin import __version__ as version

    return version

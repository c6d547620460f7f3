"""Show a page on a local address, and leave nothing behind.

The server lives inside the program: no other process, no port that outlives it. It listens on the
loopback address alone, so nobody else on the network can look.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import ThreadingHTTPServer
from types import FrameType
from typing import Any

from dualarm_pin.errors import InputError
from dualarm_pin.show.handler import LOOPBACK, Page, Talk, handler


@contextmanager
def serving(page: Page, port: int = 0, talk: Talk | None = None) -> Iterator[str]:
    """Serve `page` while the block runs and give its address.

    Args:
        page: The whole page, or what makes one each time it is opened.
        port: Port, or 0 for a free one.
        talk: What answers the page, if it asks; see `handler.Talk`.

    Raises:
        InputError: The port is taken, or there is no such port.
    """
    try:
        server = _Server((LOOPBACK, port), handler(page, talk))
    except (OSError, OverflowError) as error:
        raise InputError(
            f"port {port} cannot be used ({error}): choose another, or 0 for a free one",
            field="--port",
        ) from error
    thread = threading.Thread(target=server.serve_forever, args=(0.1,), daemon=True)
    thread.start()
    try:
        yield f"http://{LOOPBACK}:{server.server_port}/"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def serve(
    page: Page,
    port: int = 0,
    open_browser: bool = True,
    *,
    talk: Talk | None = None,
    ready: Callable[[str], None] = print,
) -> None:
    """Serve `page` until Ctrl-C or SIGTERM, then close the port and return.

    Args:
        page: The whole page, or what makes one each time it is opened.
        port: Port, or 0 for a free one.
        open_browser: Open the page in the user's browser.
        talk: What answers the page, if it asks.
        ready: Told the address once the page can be opened.

    Raises:
        InputError: The port is taken, or there is no such port.
    """
    with serving(page, port, talk) as address, _signals() as received:
        ready(address)
        if open_browser:
            import webbrowser  # looks for browsers when imported

            # A browser that stays in the foreground must not keep the program from ending.
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        # A signal may reach another thread, where it wakes nobody: so look now and then.
        while not received:
            time.sleep(0.1)


@contextmanager
def _signals() -> Iterator[list[int]]:
    """Give the list to which Ctrl-C and SIGTERM add themselves instead of ending the program."""
    received: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield received  # only the main thread may set handlers; there the caller ends the program
        return

    def handle(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    # Ctrl-C is handled too: a program started in the background inherits that it is ignored.
    before = {kind: signal.signal(kind, handle) for kind in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False
    # A second program on the same port must be told so rather than share it.
    allow_reuse_port = False

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Let a page go that was closed while it was answered; report everything else."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)

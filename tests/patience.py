"""Waiting in tests: as long as a busy machine needs, and never as part of what is judged."""

import time

LONG = 900.0  # seconds; only what hangs for good takes so long


def wait_until(happened, what):
    """Wait until `happened()` is true and return what it returned; `what` names it if it hangs."""
    deadline = time.monotonic() + LONG
    while not (value := happened()):
        assert time.monotonic() < deadline, f"{what} did not happen within {LONG:g} s"
        time.sleep(0.02)
    return value

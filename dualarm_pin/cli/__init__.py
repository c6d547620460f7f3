"""The command line: parse, call, print. Commands are imported when they are used."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

import cyclopts

from dualarm_pin import __version__
from dualarm_pin.cli.stopping import stoppable
from dualarm_pin.errors import DualArmError

DONE, NOT_FOUND, BAD_INPUT = 0, 1, 2  # exit codes
INTERRUPTED, TERMINATED = 130, 143  # as shells have them, for Ctrl-C and SIGTERM

app = cyclopts.App(
    name="dualarm-pin",
    help="Plan the joint motion of two arms that share one task, best over the whole path.",
    version=__version__,
    exit_on_error=False,
    print_error=False,
    result_action="return_value",
    suppress_keyboard_interrupt=False,
)
_COMMANDS = "paper check new explain solve place design sensitivity motion trade view export bench"
for _name in _COMMANDS.split():
    app.command(f"dualarm_pin.cli.{_name}:{_name}", name=_name)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit: 0 done and verified, 1 not found, 2 wrong input.

    Stopped before there was anything to keep: 130 by Ctrl-C, 143 by SIGTERM.
    """
    for stream in (sys.stdout, sys.stderr):  # a name that is no text must not end the program
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    with stoppable() as terminated:
        code = _run(arguments)
        sys.exit(TERMINATED if code == INTERRUPTED and terminated else code)


def _run(arguments: Sequence[str] | None) -> int:
    try:
        code = app(arguments)
        sys.stdout.flush()
    except cyclopts.CycloptsError as error:
        _complain(f"{str(error).strip()}\nSee `dualarm-pin --help`.")
        code = BAD_INPUT
    except DualArmError as error:
        _complain(str(error))
        code = BAD_INPUT
    except KeyboardInterrupt:
        _complain("stopped")
        code = INTERRUPTED
    except BrokenPipeError:  # the reader, such as `head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        code = DONE
    except MemoryError:
        _complain("the memory is full: take fewer points, starts or jobs")
        code = BAD_INPUT
    except OSError as error:  # such as a full disk behind stdout
        _complain(str(error))
        code = BAD_INPUT
    return code if isinstance(code, int) else DONE


def _complain(message: str) -> None:
    print(f"dualarm-pin: {message}", file=sys.stderr)

"""The local page: loopback only, and nothing left behind however it ends."""

import os
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request

import pytest
from patience import LONG

from dualarm_pin.errors import InputError
from dualarm_pin.show import serve, serving

PROGRAM = """
import sys
from dualarm_pin.show import serve
serve(b"<p>here</p>", 0, False, ready=lambda a: print(a, flush=True))
print("ended well", flush=True)
"""
CRASH = """
from dualarm_pin.show import serving
with serving(b"x") as address:
    print(address, flush=True)
    raise RuntimeError("on purpose")
"""


def get(address, **headers):
    request = urllib.request.Request(address, headers=headers)
    return urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=LONG)


def port_of(address):
    return int(address.rstrip("/\n").rsplit(":", 1)[1])


def is_free(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) != 0


def test_page_is_served_on_the_loopback_address_and_the_port_is_free_after():
    with serving(b"<p>page</p>") as address:
        assert address.startswith("http://127.0.0.1:")
        with get(address) as answer:
            assert answer.read() == b"<p>page</p>"
            assert answer.headers["Content-Type"] == "text/html; charset=utf-8"
        with pytest.raises(urllib.error.HTTPError, match="404"):
            get(address + "etc/passwd")
    assert is_free(port_of(address))


def test_another_name_for_this_address_is_refused():
    with (
        serving(b"secret") as address,
        pytest.raises(urllib.error.HTTPError, match="403"),
    ):
        get(address, Host="attacker.example")


def test_only_the_loopback_interface_listens():
    with serving(b"x") as address, socket.socket() as other:
        # Another address of this machine: nobody answers there.
        assert other.connect_ex(("127.0.0.2", port_of(address))) != 0


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_the_program_and_close_the_port(ending):
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        port = port_of(program.stdout.readline())
        assert not is_free(port)
        program.send_signal(ending)
        rest, _ = program.communicate(timeout=LONG)
        assert rest == "ended well\n"
        assert program.returncode == 0
        assert is_free(port)
        with pytest.raises(ProcessLookupError):  # the whole session is gone, helpers included
            os.killpg(program.pid, 0)
    finally:
        if program.poll() is None:
            program.kill()


def test_an_exception_closes_the_port():
    program = subprocess.run(
        [sys.executable, "-c", CRASH], capture_output=True, text=True, check=False
    )
    assert program.returncode == 1
    assert "on purpose" in program.stderr
    assert is_free(port_of(program.stdout))


def test_a_taken_port_is_said():
    with (
        serving(b"x") as address,
        pytest.raises(InputError, match=r"--port: port \d+ cannot be used .* choose another"),
    ):
        serve(b"y", port_of(address), open_browser=False)
    with pytest.raises(InputError, match="port 70000 cannot be used"):
        serve(b"y", 70000, open_browser=False)

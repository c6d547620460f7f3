"""A function of the user's own is compiled once, for every later process, until it changes."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from patience import LONG

from dualarm_pin import indices
from dualarm_pin.engine.jit.identity import identity_of
from dualarm_pin.engine.jit.jitted import jitted
from dualarm_pin.engine.jit.kept_module import kept_module

SOURCE = """
import numpy as np
SCALE = 2.0
def helper(x):
    return SCALE * x
def make(weight, other=None):
    def phi(A, u):
        return weight * helper(A[2, 2])
    def odd(A, u):
        return weight if other is None else 0.0
    return odd if other else phi
"""


def phi_of(text=SOURCE, weight=1.0, other=None):
    space = {"__name__": "mine"}
    exec(text, space)
    return space["make"](weight, other)


def test_the_identity_of_a_function_is_what_it_does():
    same = identity_of(phi_of())
    assert same is not None
    assert same == identity_of(phi_of("# moved by a line" + SOURCE))
    changes = [
        phi_of(weight=2.0),
        phi_of(SOURCE.replace("SCALE = 2.0", "SCALE = 3.0")),
        phi_of(SOURCE.replace("SCALE * x", "SCALE + x")),
        phi_of(SOURCE.replace("A[2, 2]", "A[1, 2]")),
    ]
    identities = [same, *map(identity_of, changes)]
    assert len(set(identities)) == len(identities)
    assert identity_of(phi_of(other=(each for each in "ab"))) is None  # no form that lasts


def test_differences_are_told_apart_by_what_they_difference():
    one, two = (indices.custom("mine", phi_of(weight=w)) for w in (1.0, 2.0))
    again = indices.custom("mine", phi_of())
    assert identity_of(one.gradient) == identity_of(again.gradient) != identity_of(two.gradient)
    assert identity_of(one.curvature) != identity_of(one.gradient)


def test_functions_below_are_compiled_with_their_caller():
    A = np.arange(36.0).reshape(6, 6)
    assert jitted(phi_of(weight=3.0))(A, np.zeros(6)) == 3.0 * 2.0 * A[2, 2]


RUN = """
import sys
from numba.core import event
from dualarm_pin import indices
from dualarm_pin.engine.jit.functions import INDEX, addresses
import mine

class Heard(event.Listener):
    count = 0
    def on_start(self, event): self.count += 1
    def on_end(self, event): pass

heard = Heard()
index = indices.custom("mine", mine.make(2.0), gradient=mine.slope(2.0))
with event.install_listener("numba:compile", heard):
    addresses("mine", (index.phi, index.curvature), INDEX[::2])
print(heard.count)
"""
MINE = """
import numpy as np
def make(weight):
    def phi(A, u):
        return weight * A[2, 2]
    return phi
def slope(weight):
    def gradient(A, u):
        G = np.zeros((6, 6))
        G[2, 2] = weight
        return G
    return gradient
"""


def started(folder: Path, home: str) -> subprocess.Popen[str]:
    python_path = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    env = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    return subprocess.Popen(
        [sys.executable, "-c", RUN],
        env=env | {"HOME": home, "PYTHONPATH": python_path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def compiled_by(process: subprocess.Popen[str]) -> int:
    out, error = process.communicate(timeout=LONG)
    assert process.returncode == 0, error
    assert error == ""
    return int(out)


@pytest.mark.slow
def test_later_processes_load_what_the_first_compiled(tmp_path):
    home = str(tmp_path)
    (tmp_path / "mine.py").write_text(MINE)
    at_once = [started(tmp_path, home) for _ in range(2)]
    assert all(compiled_by(process) > 0 for process in at_once)
    assert compiled_by(started(tmp_path, home)) == 0
    (tmp_path / "mine.py").write_text(MINE.replace("A[2, 2]", "A[2, 2] + 1.0"))
    assert compiled_by(started(tmp_path, home)) > 0
    assert compiled_by(started(tmp_path, "/dev/null")) > 0  # no home to write into: it works anew


def test_threads_that_ask_at_once_get_the_whole_module() -> None:
    text = "import time\ntime.sleep(0.2)\nentry = 1\n"
    with ThreadPoolExecutor(4) as pool:
        asked = [pool.submit(kept_module, text, [b"threads"]) for _ in range(4)]
    assert [each.result().entry for each in asked] == [1, 1, 1, 1]

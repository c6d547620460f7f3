"""Planners for the tests of batches: quick, slow, hanging, dying. Named as `bench_fakes:NAME`."""

import ctypes
import os
import pathlib
import re
import signal
import time
from dataclasses import dataclass

import numpy as np

from dualarm_pin.answer.provenance import Timing
from dualarm_pin.answer.trajectory import Checked, Trajectory


@dataclass(frozen=True)
class FakeNotes:
    """Which process answered."""

    pid: int


def quick(task, seed, cost=1.0, seconds=0.0, busy=0.0):
    """Answer at once, with figures that depend on the seed alone."""
    time.sleep(seconds)
    end = time.process_time() + busy
    while time.process_time() < end:
        pass
    h, n = task.path.h, task.cell.n
    index = cost + 0.001 * seed + np.linspace(0.0, 0.1, h)
    return Trajectory(
        q=np.full((h, n), 0.01 * seed),
        joints=task.cell.joint_names,
        arc_length=task.path.arc_length,
        checked=Checked(
            index=index,
            objective=float(index.sum()),
            position_error=np.zeros(h),
            rotation_error=np.zeros(h),
            bound_violation=np.zeros(h),
            singular_value=np.full(h, np.nan),
            clearance=None,
            arm_clearance=None,
            found=True,
        ),
        method="fake",
        solver="fake",
        timing=Timing(0.001, 0.001),
        seed=seed,
        versions={"dualarm-pin": "test"},
        notes=FakeNotes(os.getpid()),
    )


def wait_for(task, seed, gate, free):
    """Answer at once for the first seeds, and for the others when the file `gate` is there."""
    while seed >= free and not pathlib.Path(gate).exists():
        time.sleep(0.02)
    return quick(task, seed)


def hang_in_compiled_code(task, seed):
    """Never come back, in C and with Python's lock held."""
    re.match(r"(a+)+$", "a" * 64 + "b")


def segfault(task, seed):
    """Die like compiled code does."""
    ctypes.string_at(0)


def die_once(task, seed, mark):
    """Die the first time; `mark` is a folder that remembers."""
    file = pathlib.Path(mark) / f"died-{seed}"
    if not file.exists():
        file.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return quick(task, seed)


def kill_worker(task, seed):
    """Take the worker along: the parent of the process that does the run."""
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(60.0)


def fail(task, seed):
    """Raise."""
    raise RuntimeError(f"seed {seed} is\nnot to my liking")


def no_trajectory(task, seed):
    """Return something else."""
    return 42

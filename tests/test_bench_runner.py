"""Runs in a watched process: time limits, crashes, failures."""

import dataclasses
import os
import sys
from pathlib import Path

import pytest
from paper_case import TASK

from dualarm_pin import __version__
from dualarm_pin.bench.fingerprints import Fingerprints
from dualarm_pin.bench.run import BenchRun, Method
from dualarm_pin.bench.work.one_run import perform
from dualarm_pin.bench.work.runner import Runner
from dualarm_pin.files.resources import urdf_folder


def a_run(name, seed=0, time_limit=60.0, **options):
    return BenchRun(
        task="corner",
        file=str(TASK),
        overrides={},
        inputs=Fingerprints().read(TASK, ()),
        method=Method(name, None, f"bench_fakes:{name}", options),
        seed=seed,
        time_limit=time_limit,
        version=__version__,
    )


@pytest.fixture(scope="module")
def runner():
    runner = Runner()
    yield runner
    runner.close()


def test_runs_share_one_process_and_equal_a_run_done_here(runner):
    first, second = (runner.run(a_run("quick", seed=s), True) for s in (1, 2))
    assert first.status == second.status == "ok"
    assert first.figures["extra"]["pid"] == second.figures["extra"]["pid"] != os.getpid()
    here = perform(a_run("quick", seed=1))
    same = ("objective", "mean_index", "index", "found")
    assert [here.figures[k] for k in same] == [first.figures[k] for k in same]
    assert (first.trajectory.q == here.trajectory.q).all()
    assert "corner" in first.task_file


def test_a_run_that_hangs_in_compiled_code_is_killed_at_its_limit(runner):
    runner.run(a_run("quick"), False)  # the limit does not count the start of the process
    outcome = runner.run(a_run("hang_in_compiled_code", time_limit=0.5), False)
    assert outcome.status == "timed_out"
    assert outcome.reason == "the run took longer than 0.5 s"
    assert runner.run(a_run("quick"), False).status == "ok"


def test_a_run_that_kills_its_process_twice_is_set_aside(runner):
    outcome = runner.run(a_run("segfault"), False)
    assert outcome.status == "crashed"
    assert "died 2 times" in outcome.reason and "SIGSEGV" in outcome.reason
    assert runner.run(a_run("quick"), False).status == "ok"


def test_a_run_that_kills_its_process_once_is_done_again(runner, tmp_path):
    outcome = runner.run(a_run("die_once", mark=str(tmp_path)), False)
    assert outcome.status == "ok" and outcome.trajectory is None


def test_a_run_that_raises_says_why_in_one_line(runner):
    outcome = runner.run(a_run("fail", seed=3), False)
    assert outcome.status == "failed"
    assert outcome.reason.startswith("RuntimeError: seed 3 is not to my liking (bench_fakes.py:")
    row = outcome.row(a_run("fail", seed=3))
    assert row["found"] is False and row["status"] == "failed" and row["seed"] == 3


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"version": "0.0.0"}, "this worker has dualarm-pin"),
        ({"file": "/nowhere.yaml"}, "no such file"),
        ({"method": Method("x", None, "bench_fakes:nothing")}, "AttributeError"),
        ({"method": Method("x", None, "no_such_module:f")}, "ModuleNotFoundError"),
        ({"method": Method("x", None, "bench_fakes:no_trajectory")}, "a Trajectory is expected"),
    ],
)
def test_what_cannot_be_run_fails_with_its_reason(change, reason):
    outcome = perform(dataclasses.replace(a_run("quick"), **change))
    assert outcome.status == "failed" and reason in outcome.reason


def test_a_file_that_changed_since_the_batch_began_is_refused(tmp_path):
    task = tmp_path / "task.yaml"
    task.write_text(TASK.read_text().replace("../cells", str(urdf_folder() / "cells")))
    run = dataclasses.replace(a_run("quick"), file=str(task), inputs=Fingerprints().read(task, ()))
    assert perform(run).status == "ok"
    task.write_text(task.read_text() + "\n# another\n")
    outcome = perform(run)
    assert outcome.status == "failed" and "changed since the batch began" in outcome.reason


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_the_process_ends_with_its_owner(runner):
    pid = runner.run(a_run("quick"), False).figures["extra"]["pid"]
    assert Path(f"/proc/{pid}").exists()
    runner.close()
    assert not Path(f"/proc/{pid}").exists()

"""Whole batches: real workers, killed workers, killed batches, resumed ones."""

import importlib.util
import json
import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from pathlib import Path

import pytest

pytest.importorskip("distributed")
pq = pytest.importorskip("pyarrow.parquet")

from paper_case import TASK
from patience import LONG, wait_until

from dualarm_pin.answer.folder import load_trajectory
from dualarm_pin.bench.batch import run_suite
from dualarm_pin.bench.suite import Suite
from dualarm_pin.bench.work.dispatch import _outcomes
from dualarm_pin.bench.work.one_run import perform
from dualarm_pin.errors import DualArmError, InputError, MissingExtraError

BENCH = [sys.executable, "-m", "dualarm_pin", "bench", "--allow-code"]
TIMES = ("started", "run_s", "timing.wall_s", "timing.cpu_s", "extra", "clearance")


def write_suite(folder, methods, seeds=3, more=""):
    file = folder / "suite.yaml"
    listed = "\n".join(f"  - {method}" for method in methods)
    file.write_text(f"tasks: [{TASK}]\nmethods:\n{listed}\nseeds: {seeds}\n{more}")
    return file


def fake(name, label, **options):
    entry = {"call": f"bench_fakes:{name}", "name": label, "options": options}
    return json.dumps(entry)


def rows_in(log):
    return log.read_bytes().count(b"\n") if log.exists() else 0


def comparable(row):
    return {key: value for key, value in row.items() if key not in TIMES}


def table(folder):
    return [comparable(row) for row in pq.read_table(folder / "results.parquet").to_pylist()]


def serial(file):
    """Return what the runs of a suite come to when they are done here, one after another."""
    runs = Suite.load(file, allow_code=True).runs
    return [(run, perform(run)) for run in runs]


def test_failed_crashed_and_timed_out_runs_are_rows_and_the_batch_goes_on(tmp_path, run):
    file = write_suite(
        tmp_path,
        [
            fake("quick", "good"),
            fake("fail", "raises"),
            fake("segfault", "dies"),
            json.dumps({"call": "bench_fakes:hang_in_compiled_code", "name": "hangs"})[:-1]
            + ', "time_limit": 0.5}',
        ],
        seeds=1,
        more="gates: [{gate: mean_index <= 1.06, method: good}]\n",
    )
    out = tmp_path / "out"
    done = run("bench", "--allow-code", file, "--out", out, "--jobs", 2, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = {row["method"]: row for row in table(out)}
    assert {name: row["status"] for name, row in rows.items()} == {
        "good": "ok",
        "raises": "failed",
        "dies": "crashed",
        "hangs": "timed_out",
    }
    assert "4 runs" in done.stdout and "gate holds: mean_index <= 1.06" in done.stdout
    assert rows["good"]["found"] is True and rows["dies"]["found"] is False
    assert "SIGSEGV" in rows["dies"]["reason"] and "0.5 s" in rows["hangs"]["reason"]
    for column in ("seed", "objective", "evidence.verdict", "versions.dualarm-pin", "machine.host"):
        assert rows["good"][column] is not None
    for column in ("inputs.digest", "inputs.task", "inputs.cell", "inputs.robots"):
        assert rows["dies"][column]
    assert (out / "results.csv").read_text().count("\n") == 5
    best = load_trajectory(out / "best" / "paper_corner")
    assert best.objective == rows["good"]["objective"]

    again = run("bench", "--allow-code", file, "--out", out, cwd=tmp_path)
    assert again.returncode == 2 and "add --resume to continue it" in again.stderr
    before = (out / "rows.jsonl").read_bytes()
    resumed = run("bench", "--allow-code", file, "--out", out, "--resume", cwd=tmp_path)
    assert resumed.returncode == 0
    assert (out / "rows.jsonl").read_bytes() == before


@pytest.mark.slow
def test_a_run_that_kills_its_workers_is_set_aside_and_takes_no_other_along(tmp_path):
    file = write_suite(tmp_path, [fake("kill_worker", "kills"), fake("quick", "good")], 4)
    text = file.read_text().replace('"name": "kills"', '"name": "kills", "seeds": [2]')
    file.write_text(text)
    batch = run_suite(Suite.load(file, allow_code=True), tmp_path / "out", jobs=2)
    assert [row["status"] for row in batch.rows] == ["crashed", "ok", "ok", "ok", "ok"]
    assert "worker processes that died" in batch.rows[0]["reason"]


class LostOnce:
    """A future that had ended before its worker died with the result."""

    def __init__(self, end):
        self.status, self.end = "pending", end

    def result(self):
        self.status = self.end
        if self.end == "cancelled":
            raise CancelledError
        return "outcome"


class Gathers:
    def gather(self, futures, direct):
        assert all(future.status == "finished" for future in futures)
        return ["outcome"] * len(futures)


def test_a_run_that_is_done_again_after_its_worker_died_is_waited_for():
    assert _outcomes(Gathers(), [LostOnce("finished")]) == ["outcome"]
    with pytest.raises(DualArmError, match="the scheduler was lost"):
        _outcomes(Gathers(), [LostOnce("cancelled")])


def test_a_gate_that_does_not_hold_is_exit_code_1_and_a_bad_suite_2(tmp_path, run):
    file = write_suite(tmp_path, [fake("quick", "good")], 1, "gates: [mean_index <= 1.0]\n")
    done = run("bench", "--allow-code", file, "--out", "out", "--jobs", 1, cwd=tmp_path)
    assert done.returncode == 1
    assert "gate FAILED: mean_index <= 1.0" in done.stdout
    assert "1 of 1 runs do not hold it, the worst has 1.05" in done.stderr
    file.write_text("tasks: [x.yaml]\nmethods: [local]\n")
    done = run("bench", "--allow-code", file, "--out", "other", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"dualarm-pin: {file}:1: tasks.0: this file does not exist")
    assert not (tmp_path / "other").exists()


@pytest.fixture(scope="module")
def one_worker():
    """Give the address of a cluster for batches to which it does not matter where they run."""
    from dualarm_pin.bench.work.cluster import workers

    with workers(1, None) as client:
        yield client.scheduler.address


def test_keep_all_and_none(tmp_path, one_worker):
    for keep, folders in (("all", {"best", "runs"}), ("none", set())):
        file = write_suite(tmp_path, [fake("quick", "a/b <c>")], 2, f"keep: {keep}\n")
        out = tmp_path / keep
        run_suite(Suite.load(file, allow_code=True), out, address=one_worker)
        assert {p.name for p in out.iterdir() if p.is_dir()} == folders
        if keep == "all":
            kept = [load_trajectory(folder) for folder in (out / "runs").iterdir()]
            assert sorted(t.q[0, 0] for t in kept) == [0.0, 0.01]


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("found", "yes"),
        ("status", None),
        ("objective", [1]),
        ("max_bound_violation", "0"),
        ("index", [10**30]),
        ("reason", "half a letter \ud800"),
    ],
)
def test_a_row_that_no_run_left_is_refused(tmp_path, field, value):
    suite = Suite.load(write_suite(tmp_path, [fake("quick", "a")], 2), allow_code=True)
    rows = [perform(run, keep=False).row(run) for run in suite.runs]
    (tmp_path / "out").mkdir()
    log = tmp_path / "out" / "rows.jsonl"
    log.write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert run_suite(suite, log.parent, resume=True).done_before == 2
    rows[1][field] = value
    log.write_text("".join(json.dumps(row) + "\n" for row in rows))
    with pytest.raises(InputError, match=rf"rows.jsonl:2: {field}: not a row of a batch"):
        run_suite(suite, log.parent, resume=True)


def test_rows_of_another_suite_stay_but_are_not_in_the_table(tmp_path, one_worker):
    out = tmp_path / "out"
    first = Suite.load(write_suite(tmp_path, [fake("quick", "a")], 3), allow_code=True)
    run_suite(first, out, address=one_worker)
    renamed = Suite.load(write_suite(tmp_path, [fake("quick", "new name")], 2), allow_code=True)
    batch = run_suite(renamed, out, address=one_worker, resume=True)
    assert batch.done_before == 2
    assert [(row["method"], row["seed"]) for row in batch.rows] == [
        ("new name", 0),
        ("new name", 1),
    ]
    assert len((out / "rows.jsonl").read_bytes().splitlines()) == 3


@pytest.mark.parametrize("library", ["distributed", "pyarrow"])
def test_a_missing_library_is_named_before_the_first_run(tmp_path, monkeypatch, library):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == library else find(name)
    )
    suite = Suite.load(write_suite(tmp_path, [fake("quick", "a")]), allow_code=True)
    with pytest.raises(MissingExtraError, match=rf"{library}.*dualarm-pin\[bench\]"):
        run_suite(suite, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_no_scheduler_is_a_clear_message(tmp_path, monkeypatch):
    from dualarm_pin.bench.work import cluster

    monkeypatch.setattr(cluster, "CONNECT", 1.0)
    suite = Suite.load(write_suite(tmp_path, [fake("quick", "a")]), allow_code=True)
    with pytest.raises(InputError, match=r"no scheduler answers at 'tcp://127.0.0.1:9'"):
        run_suite(suite, tmp_path / "out", address="tcp://127.0.0.1:9")


@pytest.fixture
def two_workers(tmp_path):
    """Give the address of a real scheduler, and its two workers as processes."""
    note = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    command = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    started = [subprocess.Popen([*dask, *command, "--scheduler-file", note], **quiet)]
    worker = ["worker", "--scheduler-file", note, "--host", "127.0.0.1", "--no-dashboard"]
    worker += ["--nthreads", "1", "--no-nanny", "--memory-limit", "0"]
    try:
        wait_until(lambda: note.exists() and note.stat().st_size, "the start of the scheduler")
        started += [subprocess.Popen([*dask, *worker], **quiet) for _ in range(2)]
        yield json.loads(note.read_text())["address"], started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_a_worker_killed_during_the_run_changes_nothing_in_the_table(tmp_path, two_workers):
    address, processes = two_workers
    gate, out = tmp_path / "gate", tmp_path / "out"
    slow = fake("wait_for", "slow", gate=str(gate), free=4)
    file = write_suite(tmp_path, [slow, fake("fail", "raises")], 12)
    arguments = ["bench", "--allow-code", str(file), "--out", str(out), "--cluster", address]
    running = subprocess.Popen(
        [sys.executable, "-m", "dualarm_pin", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    log = out / "rows.jsonl"
    wait_until(lambda: rows_in(log) >= 4, "the fourth run")
    processes[0].send_signal(signal.SIGKILL)
    gate.touch()
    _, errors = running.communicate(timeout=LONG)
    assert running.returncode == 0, errors
    expected = tmp_path / "serial"
    expected.mkdir()
    from dualarm_pin.bench.log.table import write_tables

    rows = [json.loads(json.dumps(outcome.row(run))) for run, outcome in serial(file)]
    write_tables(expected, lambda: rows)
    assert table(out) == table(expected)


def kill_at_random(tmp_path, kills, seconds=0.05, seeds=60):
    """Kill a whole batch at random moments, continue it each time; return rows and kills."""
    file = write_suite(tmp_path, [fake("quick", "slow", seconds=seconds)], seeds)
    out = tmp_path / "out"
    chance = random.Random(kills)
    command = [
        sys.executable,
        "-m",
        "dualarm_pin",
        "bench",
        "--allow-code",
        str(file),
        "--out",
        str(out),
    ]
    command += ["--jobs", "2", "--resume"]
    counts = []
    for _ in range(kills):
        running = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        time.sleep(chance.uniform(0.3, 4.0))
        running.kill()
        running.wait()
        counts.append(rows_in(out / "rows.jsonl"))
    last = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=False)
    assert last.returncode == 0, last.stderr
    lines = (out / "rows.jsonl").read_bytes().splitlines()
    return [json.loads(line) for line in lines], counts


@pytest.mark.slow
def test_kills_at_random_moments_lose_and_double_no_row(tmp_path):
    rows, counts = kill_at_random(tmp_path, kills=5)
    assert sorted(row["seed"] for row in rows) == list(range(60))
    assert counts == sorted(counts), "a row was lost"
    assert all(row["status"] == "ok" for row in rows)
    assert [row["seed"] for row in table(tmp_path / "out")] == list(range(60))


def test_ctrl_c_ends_in_order_and_can_be_continued(tmp_path):
    gate, out = tmp_path / "gate", tmp_path / "out"
    file = write_suite(tmp_path, [fake("wait_for", "slow", gate=str(gate), free=3)], 8)
    command = [*BENCH, str(file), "--out", str(out)]
    running = subprocess.Popen(
        [*command, "--jobs", "2"], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    log = out / "rows.jsonl"
    wait_until(lambda: rows_in(log) == 3, "the third run")
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to every process of the batch
    _, errors = running.communicate(timeout=LONG)
    assert running.returncode == 130, errors
    assert "continue with --resume" in errors and "Traceback" not in errors
    assert rows_in(log) == 3
    gate.touch()
    batch = run_suite(Suite.load(file, allow_code=True), out, jobs=2, resume=True)
    assert batch.done_before == 3 and len(batch.rows) == 8


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_killed_batch_leaves_no_process(tmp_path):
    file = write_suite(tmp_path, [fake("hang_in_compiled_code", "hangs")], 2)
    command = [
        sys.executable,
        "-m",
        "dualarm_pin",
        "bench",
        "--allow-code",
        str(file),
        "--jobs",
        "2",
    ]
    running = subprocess.Popen(
        [*command, "--out", str(tmp_path / "out")], stderr=subprocess.DEVNULL
    )
    try:
        wait_until(lambda: len(busy_children(running.pid)) == 2, "the start of the runs")
        children = busy_children(running.pid)
    finally:
        running.kill()
        running.wait()
    gone = lambda: not any(Path(f"/proc/{pid}").exists() for pid in children)  # noqa: E731
    wait_until(gone, "the end of every process")


def busy_children(pid):
    """Return the processes below `pid` that do runs."""
    parents = {}
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            text = status.read_text()
            name = (status.parent / "cmdline").read_bytes().decode()
        except OSError:
            continue
        parents[int(status.parent.name)] = (int(text.rpartition(")")[2].split()[1]), name)

    def below(child):
        while child in parents and child != pid:
            child = parents[child][0]
        return child == pid

    return [
        p for p, (_, name) in parents.items() if "dualarm_pin.bench.work.child" in name and below(p)
    ]

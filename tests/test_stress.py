"""Under stress a result folder holds the old result or all of the new one, and says why."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from answers import answer
from paper_case import TASK
from patience import LONG

from dualarm_pin.answer.folder import load_trajectory, save_trajectory
from dualarm_pin.cli import main
from dualarm_pin.errors import InputError
from dualarm_pin.files import write
from dualarm_pin.files.write import reserved, write_files

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"
OLD = {"a.txt": b"old a", "b.bin": b"old b"}
NEW = {"a.txt": b"new a", "b.bin": b"new b" * 1000}


def held(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}


@pytest.mark.slow
def test_random_signals_leave_the_old_result_or_the_new_one() -> None:
    """A few moments of the long run of `benchmarks/interrupt.py`."""
    script = [str(BENCHMARKS / "interrupt.py"), "--moments", "20", "--commands", "solve", "view"]
    done = subprocess.run(
        [sys.executable, "-W", "ignore", *script],
        capture_output=True, text=True, timeout=LONG, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "20 moments, 0 failed" in done.stdout


@pytest.mark.parametrize("step", range(4))
def test_a_full_disk_leaves_the_old_files(
    step: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whichever write it stops; the last two steps are beyond them, so the new files are there."""
    write_files(tmp_path, OLD)
    calls = iter(range(10))

    def full(handle: int) -> None:
        if next(calls) == step:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    if step < len(NEW):
        with pytest.raises(InputError, match=r"a\.txt: cannot write here: No space left|b\.bin"):
            write_files(tmp_path, NEW)
    else:
        write_files(tmp_path, NEW)
    assert held(tmp_path) == (OLD if step < len(NEW) else NEW)


def test_a_limit_of_the_system_on_the_size_of_files_leaves_the_old_ones(tmp_path: Path) -> None:
    write_files(tmp_path, OLD)
    code = (
        "import resource, sys\n"
        "from pathlib import Path\n"
        "from dualarm_pin.errors import InputError\n"
        "from dualarm_pin.files.write import write_files\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "try:\n"
        "    write_files(Path(sys.argv[1]), {'a.txt': b'new a', 'b.bin': bytes(5000)})\n"
        "except InputError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert "b.bin: cannot write here: File too large" in done.stdout
    assert held(tmp_path) == OLD


def test_a_signal_while_files_are_written_waits_for_the_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_files(tmp_path, OLD)
    synchronise = write._to_disk

    def interrupted(file: Path) -> None:
        signal.raise_signal(signal.SIGINT)
        synchronise(file)

    monkeypatch.setattr(write, "_to_disk", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_files(tmp_path, NEW)
    assert held(tmp_path) == NEW


HOLD = (
    "import sys, time\n"
    "from pathlib import Path\n"
    "from dualarm_pin.files.write import reserved\n"
    "with reserved(Path(sys.argv[1])):\n"
    "    print('mine', flush=True)\n"
    "    time.sleep(600)\n"
)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_that_a_destructor_swallows_comes_again(
    number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Slow:
        def __del__(self) -> None:
            signal.raise_signal(number)

    def work(_: object) -> int:
        made = Slow()
        del made  # Python cannot raise here
        time.sleep(5.0)
        return 0

    monkeypatch.setattr("dualarm_pin.cli.app", work)
    with pytest.raises(SystemExit) as ended:
        main([])
    assert ended.value.code == 128 + number
    assert capsys.readouterr().err == "dualarm-pin: stopped\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_an_interrupt_leaves_half_made_says_nothing(
    number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Half:
        def __init__(self) -> None:
            signal.raise_signal(number)
            self.opened = True

        def __del__(self) -> None:
            assert self.opened

    monkeypatch.setattr("dualarm_pin.cli.app", lambda _: Half())
    with pytest.raises(SystemExit) as ended:
        main([])
    assert ended.value.code == 128 + number
    assert capsys.readouterr().err == "dualarm-pin: stopped\n"


def test_a_folder_belongs_to_one_run_until_its_process_is_gone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "result"
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(folder)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert other.stdout is not None
        assert other.stdout.readline() == "mine\n"
        with pytest.raises(SystemExit) as end:
            main(["solve", str(TASK), "--method", "local", "--out", str(folder)])
        assert end.value.code == 2
        assert f"{folder}: another run is writing into this folder" in capsys.readouterr().err
    finally:
        other.kill()
        other.communicate()
    assert list(folder.iterdir()) == []
    with reserved(folder):  # the kernel gave it back
        save_trajectory(folder, answer())
    load_trajectory(folder)


def test_what_was_reserved_and_not_used_is_gone(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), reserved(tmp_path / "a" / "b"):
        assert (tmp_path / "a" / "b").is_dir()
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write everywhere
    with pytest.raises(SystemExit) as end:
        main(["solve", str(TASK), "--out", str(tmp_path)])
    assert end.value.code == 2
    said = capsys.readouterr().err
    assert f"{tmp_path}: cannot write here: permission denied" in said
    assert "anchored" not in said


def test_a_closed_disk_behind_the_output_is_one_message(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "dualarm_pin", "--help"],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert "Traceback" not in done.stderr, done.stderr
    assert done.returncode == 2

"""`dualarm-pin view` as a user meets it."""

import os
import re
import signal
import subprocess
import sys
import urllib.request

import pytest
from answers import answers, task
from patience import LONG

from dualarm_pin.answer.folder import labels, save_result


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Three result folders, two of them of the same name, as `solve` writes them."""
    top = tmp_path_factory.mktemp("results")
    made = [top / "monday" / "corner", top / "tuesday" / "corner", top / "other"]
    for folder, trajectory in zip(made, answers().values(), strict=True):
        save_result(folder, task(), trajectory)
    return made


def test_one_file_with_three_results(folders, tmp_path, run):
    file = tmp_path / "deep" / "report.html"
    done = run("view", *folders, "--html", file, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"written to {file}\n"
    text = file.read_text("utf-8")
    assert len(text) < 8_000_000
    assert "<title>ns16_pair: 3 results</title>" in text


def test_results_of_one_name_are_told_apart(folders):
    assert labels(folders) == ["monday/corner", "tuesday/corner", "other"]
    assert labels(folders[1:]) == ["corner", "other"]
    assert len(set(labels([folders[0], *folders]))) == 4


def test_live_page_is_there_until_the_signal(folders):
    program = subprocess.Popen(
        [sys.executable, "-m", "dualarm_pin", "view", str(folders[0]), "--no-browser"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        address = re.match(r"(http://127\.0\.0\.1:\d+/) \(Ctrl-C ends it\)", _line(program))[1]
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        with opener.open(address, timeout=LONG) as answer:
            assert b"<title>ns16_pair: " in answer.read()
        program.send_signal(signal.SIGTERM)
        _, complaints = program.communicate(timeout=LONG)
        assert (program.returncode, complaints) == (0, "")
        with pytest.raises(ProcessLookupError):
            os.killpg(program.pid, 0)
    finally:
        if program.poll() is None:
            program.kill()


def _line(program):
    line = program.stdout.readline()
    assert line, program.stderr.read()
    return line


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nowhere"], "nowhere/result.json: no such file: give the folder that `solve --out`"),
        ([], "RESULT"),
        (["{0}", "--port", "70000", "--no-browser"], "--port: port 70000 cannot be used"),
        (
            ["{0}", "--html", "{0}/result.json/x.html"],
            "result.json: cannot write here: File exists",
        ),
    ],
)
def test_wrong_input_is_one_message(folders, arguments, message, run, tmp_path):
    done = run("view", *(text.format(*folders) for text in arguments), cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr

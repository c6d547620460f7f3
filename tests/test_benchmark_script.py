"""The benchmark of solvers: its gates can fail, and it runs."""

import json
import subprocess
import sys
from itertools import product
from pathlib import Path

import pytest
from patience import LONG
from scripts import script_of

FOLDER = Path(__file__).resolve().parents[1] / "benchmarks"
BASELINE = json.loads((FOLDER / "baseline.json").read_text())


@pytest.fixture(scope="module")
def script():
    return script_of(FOLDER / "solvers.py")


@pytest.fixture
def report():
    rows = {}
    for gate in BASELINE["gates"]:
        row = rows.setdefault(gate["group"], {}).setdefault(gate["solver"], {})
        row[gate["figure"]] = gate.get("at_least", gate.get("at_most"))
    return rows


def test_a_run_on_the_limits_passes(script, report, capsys):
    assert script.compare(report, FOLDER / "baseline.json", None) == 0
    assert "FAILED" not in capsys.readouterr().out


@pytest.mark.parametrize("number", range(len(BASELINE["gates"])))
def test_every_gate_can_fail(script, report, number, capsys):
    gate = BASELINE["gates"][number]
    worse = 0.99 if "at_least" in gate else 1.01
    report[gate["group"]][gate["solver"]][gate["figure"]] *= worse
    assert script.compare(report, FOLDER / "baseline.json", None) == 1
    assert capsys.readouterr().out.count("gate FAILED") == 1


def test_a_solver_that_is_not_installed_is_skipped_visibly(script, report, capsys):
    del report["P31 anchored"]["Drake SNOPT"]
    assert script.compare(report, FOLDER / "baseline.json", None) == 0
    assert "gate skipped: P31 anchored, Drake SNOPT" in capsys.readouterr().out


def test_the_baseline_was_measured(script):
    measured = BASELINE["measured"]
    assert measured["versions"]["dualarm-pin"] and measured["machine"]["processor"]
    for gate in BASELINE["gates"]:
        assert gate["figure"] in measured["groups"][gate["group"]][gate["solver"]]


@pytest.mark.slow
def test_the_script_runs_and_draws(tmp_path):
    command = [sys.executable, str(FOLDER / "solvers.py"), "--starts", "1", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=False)
    assert done.returncode in (0, 1), done.stderr
    assert "engine is faster" in done.stdout
    assert (tmp_path / "solvers.svg").read_text().count("<svg") == 1
    assert "engine" in json.loads((tmp_path / "solvers.json").read_text())["groups"]["P31 random"]


@pytest.fixture(scope="module")
def clearance():
    return script_of(FOLDER / "clearance.py")


def finished(clearance, spoil=()):
    """Return what the study keeps of all its cases, the best objective 10; some are spoilt."""
    every = product(clearance.BASES, clearance.THINGS, clearance.CLEARANCES)
    for case in (clearance.Case(*each) for each in every):
        run = {"forbidden": "", "found": True, "objective": 10.0, "at": 0.1, "between": 0.1}
        if case.forbidden:
            run |= {"forbidden": "they stay within", "found": False}
        run |= {"seconds": 1.0, "message": "", "package": clearance._package()}
        for effort in ("quick", "normal"):
            key = f"{case.name}, {effort}, 0"
            yield {"key": key, **run} | next((c for k, c in spoil if k == key), {})


FREE, HELD = "2.2 m, nothing, 0.05 m, normal, 0", "2.2 m, box, 0.05 m, normal, 0"


@pytest.mark.parametrize(
    ("spoil", "fails"),
    [
        ([], 0),
        ([(FREE, {"found": False})], 1),
        ([(HELD, {"forbidden": ""})], 1),
        ([(FREE, {"objective": 11.0})], 0),
        ([(FREE, {"objective": 11.5}), (FREE.replace("2.2", "2.3"), {"objective": 30.0})], 1),
        ([(FREE, {"forbidden": "they stay within", "found": False})], 1),
    ],
)
def test_the_study_of_clearance_fails_where_it_must(clearance, tmp_path, spoil, fails, capsys):
    file = tmp_path / "kept.jsonl"
    file.write_text("".join(json.dumps(run) + "\n" for run in finished(clearance, spoil)))
    before = file.read_text()
    assert clearance.study(["quick", "normal"], range(1), 1, file) == fails
    assert file.read_text() == before, "what is finished is not made again"
    assert "normal: 35 found" in capsys.readouterr().out or spoil


def test_the_study_of_clearance_stops_with_what_there_is(clearance, tmp_path, monkeypatch, capsys):
    file = tmp_path / "kept.jsonl"
    runs = [run for run in finished(clearance) if run["key"] != FREE]
    file.write_text("".join(json.dumps(run) + "\n" for run in runs))

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(clearance, "_run", stopped)
    assert clearance.study(["quick", "normal"], range(1), 1, file) == 1
    assert "normal: 34 found" in capsys.readouterr().out

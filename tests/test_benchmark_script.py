"""The benchmark of solvers: its gates can fail, and it runs."""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest
from patience import LONG

FOLDER = Path(__file__).resolve().parents[1] / "benchmarks"
BASELINE = json.loads((FOLDER / "baseline.json").read_text())


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("benchmark_solvers", FOLDER / "solvers.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


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

"""The table of best known paths: it can fail either way, and it is raised where asked."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from scripts import script_of

FOLDER = Path(__file__).resolve().parents[1] / "benchmarks"
KNOWN = json.loads((FOLDER / "best_known.json").read_text(encoding="utf-8"))
TASKS = ["--tasks", "paper_corner,circle", "--seeds", "2", "--effort", "normal"]


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script, with a planner that finds the best known values at once."""
    module = script_of(FOLDER / "search.py")

    def planned(task: object, **_: object) -> SimpleNamespace:
        k = len(task.path.position)  # type: ignore[attr-defined]
        name = "paper_corner" if k == 31 else "circle"
        q = np.zeros((k, 12))
        return SimpleNamespace(objective=KNOWN[name]["objective"], found=True, evidence=None, q=q)

    monkeypatch.setattr(module.dp, "plan_global", planned)
    monkeypatch.setattr(module, "ensure_compiled", lambda tell: 0.0)
    return module


def falsified(folder: Path, factor: float) -> Path:
    """Return a table whose values are the known ones times a factor."""
    table = {k: v | {"objective": v["objective"] * factor} for k, v in KNOWN.items()}
    path = folder / "table.json"
    path.write_text(json.dumps(table), encoding="utf-8")
    return path


def test_what_is_as_good_as_the_table_passes(script, capsys):
    assert script.main(TASKS) == 0
    assert "2 of 2" in capsys.readouterr().out


def test_better_than_the_table_fails_and_raises_it(script, tmp_path, capsys):
    table = falsified(tmp_path, 1.01)
    before = table.read_text(encoding="utf-8")
    assert script.main([*TASKS, "--table", str(table)]) == 1
    assert "use --raise" in capsys.readouterr().out
    assert table.read_text(encoding="utf-8") == before
    script.main([*TASKS, "--table", str(table), "--raise"])
    raised = json.loads(table.read_text(encoding="utf-8"))
    assert raised["circle"]["objective"] == KNOWN["circle"]["objective"]
    assert raised["b01"]["objective"] == pytest.approx(1.01 * KNOWN["b01"]["objective"])
    assert script.main([*TASKS, "--table", str(table)]) == 0


def test_normal_falls_behind_a_table_that_is_lower(script, tmp_path, capsys):
    table = falsified(tmp_path, 0.99)
    assert script.main([*TASKS, "--table", str(table)]) == 1
    assert "falls behind the table on paper_corner, circle" in capsys.readouterr().out
    quick = [*TASKS[:-1], "quick", "--table", str(table)]
    assert script.main(quick) == 0  # it may miss: what it promises is the first line

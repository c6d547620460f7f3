"""A column is added in one place, and every reader of a batch has it."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

pq = pytest.importorskip("pyarrow.parquet")

from paper_case import TASK

from dualarm_pin.bench import columns
from dualarm_pin.bench.columns import Column, Shown
from dualarm_pin.bench.gates import read_gate
from dualarm_pin.bench.log.table import write_tables
from dualarm_pin.bench.report import statistics as stats
from dualarm_pin.bench.report.html_tables import problem_table
from dualarm_pin.bench.suite import Suite
from dualarm_pin.bench.work.one_run import perform
from dualarm_pin.files.suite_spec import GateEntry


def joint_travel(answered):
    return float(np.abs(np.diff(answered.trajectory.q, axis=0)).sum()) + 7.25


@pytest.fixture
def suite(tmp_path):
    methods = [{"call": "bench_fakes:quick", "name": "a"}, {"call": "bench_fakes:fail"}]
    file = tmp_path / "suite.yaml"
    file.write_text(json.dumps({"tasks": [str(TASK)], "methods": methods, "seeds": 2}))
    return Suite.load(file, allow_code=True)


def test_one_entry_adds_a_column_to_rows_tables_gates_and_report(tmp_path, suite, monkeypatch):
    shown = Shown("joint travel [rad]", "largest", ".2f", bad=lambda value: value > 7.0)
    added = Column("joint_travel", answer=joint_travel, shown=(shown,))
    monkeypatch.setattr(columns, "COLUMNS", (*columns.COLUMNS, added))
    rows = [json.loads(json.dumps(perform(run).row(run))) for run in suite.runs]
    assert [row.get("joint_travel") for row in rows] == [7.25, 7.25, None, None]
    write_tables(tmp_path, lambda: rows)
    table = pq.read_table(tmp_path / "results.parquet").to_pylist()
    assert [row["joint_travel"] for row in table] == [7.25, 7.25, None, None]
    with (tmp_path / "results.csv").open(newline="") as file:
        assert [row["joint_travel"] for row in csv.DictReader(file)] == ["7.25", "7.25", "", ""]
    brief = [columns.brief(row) for row in rows]
    for limit, holds in (("7.3", True), ("7.2", False)):
        entry = GateEntry(gate=f"joint_travel <= {limit}", method="a")
        gate = read_gate(entry, ["paper_corner"], ["a", "bench_fakes:fail"])
        assert (gate.failure(brief) is None) == holds
    page = problem_table(next(iter(stats.summaries(brief).values())))
    assert "joint travel [rad]" in page
    assert page.count('<td class="bad">7.25</td>') == 1


def test_without_the_entry_no_reader_knows_it(suite):
    rows = [perform(run).row(run) for run in suite.runs[:1]]
    brief = [columns.brief(row) for row in rows]
    assert "joint_travel" not in rows[0]
    assert "joint travel" not in problem_table(next(iter(stats.summaries(brief).values())))
    gate = read_gate(GateEntry(gate="joint_travel <= 1"), ["paper_corner"], ["a"])
    assert gate.failure(brief).startswith("no run has a joint_travel")


def test_what_was_asked_wins_over_what_a_method_says(suite):
    run = suite.runs[0]
    outcome = perform(run)
    forged = replace(outcome, figures={**outcome.figures, "seed": 99, "key": "x"})
    assert forged.row(run)["seed"] == run.seed
    assert forged.row(run)["key"] == run.key


def test_names_are_unique_and_text_columns_are_read_by_nobody():
    names = [column.name for column in columns.COLUMNS]
    assert len(set(names)) == len(names)
    assert not [c.name for c in columns.COLUMNS if c.text and (c.kept or c.shown)]
    headings = [shown.heading for _, shown in stats.shown_columns()]
    assert len(set(headings)) == len(headings)

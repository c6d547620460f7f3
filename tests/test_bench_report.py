"""The report: every number where it belongs, every name escaped, one file."""

import json
import math
import re
from html.parser import HTMLParser

import pytest

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

from paper_case import TASK

from dualarm_pin.bench.batch import run_suite
from dualarm_pin.bench.report import statistics as stats
from dualarm_pin.bench.report.charts import map_chart, profile_chart
from dualarm_pin.bench.report.html_tables import problem_table
from dualarm_pin.bench.report.page import _maps, _order, write_report
from dualarm_pin.bench.suite import Suite
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.files.suite_spec import MapEntry

NASTY = "<script>alert(1)</script> & \"x\" 'y' {{data}}"


def row(method, seed=0, **figures):
    base = {
        "task": "t",
        "variant": "",
        "method": method,
        "seed": seed,
        "status": "ok",
        "reason": "",
        "found": True,
        "objective": 2.0,
        "mean_index": 0.5,
        "max_bound_violation": 0.0,
        "max_position_error": 1e-9,
        "max_rotation_error": 2e-9,
        "max_joint_step": 0.1,
        "min_clearance": 0.2,
        "timing.wall_s": 1.0,
        "time_limit": 60.0,
        "evidence.verdict": "best_known",
        "evidence.gap": None,
    }
    return base | figures


def test_a_summary_takes_the_best_of_those_found_and_the_worst_violation_of_all():
    rows = [
        row("a", 0, objective=2.0, mean_index=0.5),
        row("a", 1, objective=1.0, mean_index=0.6, min_clearance=-0.1),
        row("a", 2, objective=0.1, mean_index=0.01, found=False, max_bound_violation=0.3),
        row("a", 3, status="crashed", found=False)
        | dict.fromkeys(("objective", "mean_index", "max_bound_violation", "timing.wall_s")),
    ]
    (summary,) = stats.summaries(rows)["t", ""]
    assert (summary.found, summary.statuses.total()) == (2, 4)
    assert summary.figures["objective, best found"] == 1.0
    assert summary.figures["clearance [m]"] == -0.1
    assert summary.figures["mean index, best"] == 0.5
    assert summary.figures["mean index, median"] == 0.55
    assert summary.figures["bound violation, largest"] == 0.3
    assert summary.statuses == {"ok": 3, "crashed": 1}


def test_an_objective_of_zero_or_below_can_be_the_best():
    rows = [row("a", 0, objective=0.0, min_clearance=0.1), row("a", 1, objective=1.0)]
    (summary,) = stats.summaries(rows)["t", ""]
    assert summary.figures["objective, best found"] == 0.0
    assert summary.figures["clearance [m]"] == 0.1
    groups = stats.summaries([row("a", objective=-2.0), row("b", objective=-1.0)])["t", ""]
    assert re.findall(r'<td class="best">(.*?)</td>', problem_table(groups)) == ["-2"]


def test_a_map_crosses_contact_at_exactly_zero():
    touching = row("a", min_clearance=0.0) | {"set": {"smoothness": 1.0, "radius": 1.0}}
    chart = MapEntry(x="smoothness", y="radius")
    assert _maps([chart], [touching]).count('class="cross"') == 2


def test_shifted_geometric_mean():
    assert stats.shifted_geometric_mean([3.0, 3.0], 1.0) == pytest.approx(3.0)
    assert stats.shifted_geometric_mean([0.0, 3.0], 1.0) == pytest.approx(1.0)
    assert stats.shifted_geometric_mean([]) is None


def test_profiles_count_what_was_not_found_as_never():
    rows = [
        row("a", 0, objective=1.0),
        row("b", 0, objective=1.5),
        row("b", 1, objective=0.1, found=False),
    ]
    excess = stats.excesses(rows)
    assert excess["a"] == [1.0] and excess["b"] == [1.5, math.inf]
    assert stats.profile(excess["b"]) == [(1.5, 0.5)]
    negative = stats.excesses([row("a", objective=-2.0), row("b", objective=-1.0)])
    assert negative["b"] == [1.5]


def test_time_counts_the_limit_where_nothing_was_found():
    rows = [row("a", 0), row("a", 1, found=False)]
    assert stats.times(rows)["a"] == [1.0, 60.0]
    assert stats.time_ratios(rows)["a"] == [1.0, math.inf]


def test_a_map_marks_the_least_and_hatches_what_was_not_found():
    svg = map_chart({(0.0, 0.0): 1.0, (1.0, 0.0): 0.5, (0.0, 1.0): None}, "x", "y<", "c")
    assert svg.count('class="least"') == 1 and svg.count('fill="url(#none)"') == 1
    crossed = map_chart({(0.0, 0.0): 1.0, (1.0, 0.0): 0.5}, "x", "y", "c", [(1.0, 0.0)])
    assert crossed.count('class="cross"') == 2
    assert 'class="least"><title>x 0, y 0: 1<' in crossed
    assert "y&lt;" in svg and "x 1, y&lt; 0: 0.5" in svg


def test_a_profile_without_any_answer_is_still_a_chart():
    assert profile_chart({"a": []}, "ratio").startswith("<svg")


class Page(HTMLParser):
    """Collects tags, text and what a page would fetch."""

    def __init__(self, html):
        super().__init__()
        self.scripts, self.fetches, self.text, self.open, self.ids = 0, [], [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.scripts += tag == "script"
        self.ids.append(attributes.get("id"))
        self.fetches += [v for k, v in attributes.items() if k in ("src", "href") and v != "data:,"]
        self.open.append(tag)

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "style"):
            self.text.append(data)


@pytest.fixture(scope="module")
def batch(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    task, cell = folder / "task <b>.yaml", urdf_folder() / "cells"
    task.write_text(TASK.read_text().replace("../cells", str(cell)))
    methods = [
        {"call": "bench_fakes:quick", "name": NASTY},
        {"call": "bench_fakes:quick", "name": "dear", "options": {"cost": 2.0}},
        {"call": "bench_fakes:fail", "name": "fails"},
    ]
    suite = {
        "title": NASTY,
        "tasks": ["task*.yaml"],
        "methods": methods,
        "overrides": {"grid": {"smoothness": [1.0, 2.0], "two_stage.smoothness": [1.0, 3.0]}},
        "maps": [{"x": "smoothness", "y": "two_stage.smoothness", "label_x": NASTY}],
        "gates": [{"gate": "mean_index <= 1.5", "method": "dear"}],
        "limitations": [f"`code` {NASTY}"],
    }
    file = folder / "suite.yaml"
    file.write_text(json.dumps(suite))
    loaded = Suite.load(file, allow_code=True)
    batch = run_suite(loaded, folder / "out", jobs=1)
    write_report(loaded, batch, "dualarm-pin bench 'suite.yaml' --out out")
    return batch


@pytest.fixture(scope="module")
def html(batch):
    return (batch.folder / "report.html").read_text(encoding="utf-8")


def test_the_report_says_everything_and_escapes_it(html):
    page = Page(html)
    text = " ".join(" ".join(page.text).split())
    for words in (
        "Gates",
        "fails: 4 of 4 runs do not hold it, the worst has 2.05",
        "Maps",
        "Performance profiles",
        "shifted geometric mean",
        "bound violation, largest",
        "Limitations",
        "dualarm-pin bench 'suite.yaml' --out out",
        "Runs without an answer: 4",
        "seed 0 is not to my liking",
        "smoothness=1.0, two_stage.smoothness=3.0",
        "task <b>",
    ):
        assert words in text, words
    assert text.count("<script>alert(1)</script>") >= 5
    assert page.scripts == 3, "a name became a script"
    assert page.fetches == []
    assert page.ids.count("player") == 1


def test_no_table_shows_a_mean_without_the_bound_violation(html):
    tables = re.findall(r"<table>(.*?)</table>", html, re.S)
    ranked = [table for table in tables if "mean index" in table or "objective" in table]
    assert len(ranked) >= 5
    assert all("bound violation" in table for table in ranked)


def test_without_trajectories_the_page_has_no_script(batch, tmp_path):
    from dataclasses import replace

    empty = replace(batch, folder=tmp_path)
    suite = Suite.load(batch.folder.parent / "suite.yaml", allow_code=True)
    write_report(suite, empty, "x")
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert page.scripts == 0 and "No trajectory to show" in " ".join(page.text)


@pytest.mark.parametrize(
    ("clearance", "touches"), [(0.0, True), (-0.1, True), (0.1, False), (None, False)]
)
def test_contact_at_exactly_zero_is_not_free(clearance, touches):
    """Between variants what is free stands first, whatever its index."""
    least = row("a", variant="near", mean_index=0.1, min_clearance=clearance)
    free = row("a", variant="far", mean_index=0.9, min_clearance=0.2)
    assert (_order(free, least) < _order(least, free)) == touches

"""The report without a browser: what its tables say, what is refused, what is escaped."""

import base64
import gzip
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from ns16_pair import corner, motions, pair

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.relative import Relative
from dualarm_pin.show import Result, report_page, result_of, write_report
from dualarm_pin.task import Task

SUMMARY = {
    "found": True,
    "method": "global",
    "solver": "engine",
    "mean_index": 0.40627,
    "objective": 12.7308877,
    "max_joint_step": 0.245,
    "evidence": {
        "verdict": "best_known_bounded",
        "laws": {"anchored": {"starts": 300, "converged": 280, "minima": 46, "best_hits": 9}},
        "missed_share_95": 0.005,
        "lower_bound": 12.7308,
        "gap": 7e-6,
    },
    "timing": {"wall_s": 5.25, "cpu_s": 9.5, "compile_s": 0.0},
    "seed": 0,
    "versions": {"pin": "4.1.0"},
}


def results():
    cell, path = pair(), corner()
    found = []
    for k, (q, index) in enumerate(motions()):
        clearance = np.array([cell.clearance(row).distance for row in q])
        found.append(
            Result(f"result {k}", cell, path, q, index, clearance, summary=SUMMARY, units="m²")
        )
    return found


def head_of(page):
    text = page.decode("utf-8")
    data = re.search(r'<script id="data" type="text/plain">([^<]*)</script>', text).group(1)
    raw = gzip.decompress(base64.b64decode(data))
    return json.loads(raw[4 : 4 + int.from_bytes(raw[:4], "little")])


def cells(head, section, row):
    table = next(s for s in head["results"] if s["title"] == section)
    return dict(table["rows"])[row]


def test_tables_say_what_was_checked():
    head = head_of(report_page(results(), title="three"))
    assert head["title"] == "three"
    assert cells(head, "Result", "found") == ["yes"] * 3
    assert cells(head, "Result", "objective")[0] == "12.73089"
    assert cells(head, "Result", "mean index")[0] == "0.4063 m²"
    assert "280 converged, 46 minima, best hit 9×" in cells(head, "Evidence", "starts")[0]
    assert cells(head, "Evidence", "gap to it")[0] == "0.0007 %"
    assert "lower bound" in cells(head, "Evidence", "verdict")[0]
    assert cells(head, "Provenance", "seed") == ["0"] * 3
    assert "ns16.urdf" in cells(head, "Provenance", "files read (SHA-256)")[0]
    assert pair().sources[1].sha256[:16] in cells(head, "Provenance", "files read (SHA-256)")[0]


def test_what_is_not_known_is_left_out_or_said():
    bare = [replace(r, summary={"found": False}, clearance=None) for r in results()[:1]]
    head = head_of(report_page(bare))
    assert cells(head, "Result", "found") == ["NO"]
    assert cells(head, "Result", "smallest clearance") == ["unknown"]
    assert not next(s for s in head["results"] if s["title"] == "Evidence")["rows"]
    assert head["runs"][0]["clearance"] is None


def test_collision_is_said():
    hit = replace(results()[0], clearance=np.linspace(0.1, -0.01, 31), nearest="arm1/a - arm2/b")
    text = cells(head_of(report_page([hit])), "Result", "smallest clearance")[0]
    assert text == "-0.01 m IN COLLISION\narm1/a - arm2/b"


def test_a_solved_task_brings_its_curves(tmp_path):
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    q, index = motions()[0]
    known = {"max_position_error": 1e-9, "max_rotation_error": 1e-9, "max_bound_violation": 0.0}
    trajectory = Trajectory(
        q=q, joints=task.cell.joint_names, arc_length=task.path.arc_length, index=index,
        found=True, method="global", solver="engine", objective=12.73, arc_mean_index=0.4,
        max_joint_step=0.2, extra={"evidence_text": "Best of\n 9 starts."}, **known,
    )  # fmt: skip
    result = result_of("mine", task, trajectory)
    J_r = Relative(task.cell, q[4]).J_r
    assert result.singular_value[4] == pytest.approx(np.linalg.norm(J_r, -2))
    assert result.clearance[4] == pytest.approx(task.cell.clearance(q[4]).distance)
    assert np.all(result.between_arms >= result.clearance)
    tips = np.linalg.norm(Relative(task.cell, q[4]).T_e1_e2.translation)
    assert result.between_arms[4] <= tips  # the flanges belong to the arms
    assert result.units == "m²"
    assert "smoothness" in result.task
    head = head_of(report_page([result]))
    assert cells(head, "Evidence", "in words") == ["Best of 9 starts."]
    assert cells(head, "Result", "smallest clearance")[0].endswith("\n" + result.nearest)
    assert head["runs"][0]["between_arms"]["shape"] == [31]


def test_page_is_one_small_file_and_names_are_escaped(tmp_path):
    bad = '</script><script>alert("x")</script>'
    named = [replace(r, label=bad, task=bad, quantity=bad) for r in results()]
    file = tmp_path / "report.html"
    write_report(file, named, title=bad)
    text = file.read_text("utf-8")
    assert bad not in text
    assert file.stat().st_size < 8_000_000
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", text)


def test_what_does_not_fit_is_refused():
    with pytest.raises(InputError, match="there is no result to report"):
        report_page([])
    wrong = replace(results()[0], clearance=np.zeros(30))
    with pytest.raises(ShapeError, match=r"clearance: result 'result 0': \(31,\) is expected"):
        report_page([wrong])

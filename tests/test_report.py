"""The report without a browser: what its tables say, what is refused, what is escaped."""

import base64
import gzip
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from answers import BOUND, EVIDENCE, answer, answers, changed, near, task
from ns16_pair import pair

from dualarm_pin.answer.evidence import Evidence
from dualarm_pin.answer.summary import summary
from dualarm_pin.answer.verify import verified
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.relative import Relative
from dualarm_pin.show import report_page, write_report


def results():
    return {label: (task(), t) for label, t in answers().items()}


def page_of(*trajectories):
    return report_page({f"result {k}": (task(), t) for k, t in enumerate(trajectories)})


def unpacked(page):
    text = page.decode("utf-8")
    data = re.search(r'<script id="data" type="text/plain">([^<]*)</script>', text).group(1)
    raw = gzip.decompress(base64.b64decode(data))
    end = 4 + int.from_bytes(raw[:4], "little")
    return json.loads(raw[4:end]), raw[end:]


def head_of(page):
    return unpacked(page)[0]


def curve(page, run, name):
    head, raw = unpacked(page)
    reference = head["runs"][run][name]
    return np.frombuffer(raw, "<f4", reference["shape"][0], reference["at"])


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
    assert cells(head, "Evidence", "gap to it")[0] == "0.00069 %"
    assert cells(head, "Evidence", "in words")[0] == "Best of 9 starts."
    assert cells(head, "Evidence", "bounds that hold")[0] == "98"
    assert "lower bound" in cells(head, "Evidence", "verdict")[0]
    assert cells(head, "Provenance", "seed") == ["0"] * 3
    assert "ns16.urdf" in cells(head, "Provenance", "files read (SHA-256)")[0]
    assert pair().sources[1].sha256[:16] in cells(head, "Provenance", "files read (SHA-256)")[0]


def test_what_is_not_known_is_left_out_or_said():
    lost = changed(replace(answer(), evidence=Evidence()), found=False, clearance=None)
    head = head_of(page_of(changed(lost, singular_value=np.full(31, np.nan))))
    assert cells(head, "Result", "found") == ["NO"]
    assert cells(head, "Result", "smallest clearance") == ["unknown"]
    evidence = next(s for s in head["results"] if s["title"] == "Evidence")["rows"]
    assert [name for name, _ in evidence] == ["verdict"]
    assert head["runs"][0]["clearance"] is head["runs"][0]["singular_value"] is None


@pytest.mark.parametrize(("least", "said"), [(-0.01, True), (0.0, True), (1e-3, False)])
def test_collision_is_said_and_contact_is_one(least, said):
    hit = changed(answer(), clearance=near(np.linspace(0.1, least, 31)))
    text = cells(head_of(page_of(hit)), "Result", "smallest clearance")[0]
    assert text.endswith("\narm1/a - arm2/b")
    assert ("IN COLLISION" in text) == ("IN COLLISION" in summary(task(), hit)) == said


def test_a_wrong_bound_is_said():
    wrong = replace(BOUND, value=12.74)
    bad = replace(EVIDENCE, verdict="best_known", bound=wrong)
    head = head_of(page_of(replace(answer(), evidence=bad)))
    assert cells(head, "Evidence", "verdict")[0].endswith("; the lower bound is wrong")
    assert "above this very path" in cells(head, "Evidence", "lower bound")[0]
    assert cells(head, "Evidence", "gap to it")[0] == "-0.072 %"


def test_the_page_draws_what_the_check_found():
    t, page = answer(), page_of(answer())
    q, checked = t.q, t.checked
    J_r = Relative(task().cell, q[4]).J_r
    assert checked.singular_value[4] == pytest.approx(np.linalg.norm(J_r, -2))
    assert np.all(checked.arm_clearance.distance >= checked.clearance.distance)
    tips = np.linalg.norm(Relative(task().cell, q[4]).T_e1_e2.translation)
    assert checked.arm_clearance.distance[4] <= tips  # the flanges belong to the arms
    for name, values in (
        ("clearance", checked.clearance.distance),
        ("between_arms", checked.arm_clearance.distance),
        ("singular_value", checked.singular_value),
    ):
        np.testing.assert_allclose(curve(page, 0, name), values, rtol=1e-6)
    head = head_of(page)
    pair_of_links = " - ".join(checked.clearance.closest)
    assert cells(head, "Result", "smallest clearance")[0].endswith("\n" + pair_of_links)
    assert "smoothness" in head["runs"][0]["task"]


def test_hulls_that_touch_are_no_collision_where_the_meshes_are_apart(monkeypatch):
    """Page, summary and result say the same: the meshes decide, and nothing is measured again."""
    hull, exact = pair().pairs[3], 0.02
    asked = []

    def distances(cell, q):
        return np.where(np.arange(len(cell.pairs)) == 3, -0.01, 1.0)

    def distance(cell, q, number, *, exact=False):
        asked.append(exact)
        return 0.02 if exact else float(distances(cell, q)[number])

    monkeypatch.setattr(Cell, "distances", distances)
    monkeypatch.setattr(Cell, "distance", distance)
    touched = verified(task(), answer().q, method="global", solver="engine")
    assert touched.min_clearance == exact
    asked.clear()
    head = head_of(page_of(touched))
    text = cells(head, "Result", "smallest clearance")[0]
    assert text == f"0.02 m\n{hull[0]} - {hull[1]}"
    assert "COLLISION" not in summary(task(), touched)
    assert not asked


def test_page_is_one_small_file_and_names_are_escaped(tmp_path):
    bad = '</script><script>alert("x")</script>'
    named = replace(
        answer(), method=bad, solver=bad, message=bad, versions={bad: bad},
        evidence=replace(EVIDENCE, laws={bad: EVIDENCE.laws["anchored"]}, sentences=bad),
    )  # fmt: skip
    named = changed(named, clearance=near(np.ones(31), bad, bad))
    asked = replace(task(), record={"cell": {"name": bad}}, index=replace(task().index, name=bad))
    file = tmp_path / "report.html"
    write_report(file, {bad: (asked, named), "other": results()["result 1"]}, title=bad)
    text = file.read_text("utf-8")
    assert bad not in text
    assert file.stat().st_size < 8_000_000
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", text)


def test_what_does_not_fit_is_refused():
    with pytest.raises(InputError, match="there is no result to report"):
        report_page({})
    with pytest.raises(ShapeError, match=r"clearance: \(31,\) is expected; given \(30,\)"):
        changed(answer(), clearance=near(np.zeros(30)))

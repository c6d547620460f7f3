"""The verdict for every combination of findings, and what the sentences may not say."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from answers import answer, changed
from evidence_cases import minima_of_six, six_points

from dualarm_pin.answer.evidence import Bound, Evidence, LawCount, LocalCheck, Searches
from dualarm_pin.answer.result_json import result_json
from dualarm_pin.errors import ShapeError
from dualarm_pin.evidence import examine
from dualarm_pin.evidence.laws import count, laws_suffice, missed_share
from dualarm_pin.evidence.sentences import STOPPING_RULE
from dualarm_pin.evidence.verdict import Findings, conclude, with_bound_without_clearance
from dualarm_pin.search.law import Drawn
from dualarm_pin.solution import Solutions

FORBIDDEN = ("global", "certified", "optimal within", "chance of being", "guarantee", "proven")
STRICT = LocalCheck(
    objective=12.7309,
    feasibility=1e-12,
    stationarity=1e-9,
    min_multiplier=0.0093,
    active_bounds=98,
    curvature_min=0.284,
    free_directions=88,
    sigma_min=0.21,
    return_radius=0.2,
    return_share=1.0,
    limit_cost={"arm1/joint_5": 22.1, "arm2/joint_5": 10.7},
)
LOCALS = {
    "strict": STRICT,
    "flat": replace(STRICT, curvature_min=0.0),
    "saddle": replace(STRICT, curvature_min=-0.5),
    "moving": replace(STRICT, stationarity=0.1),
    "edge": replace(STRICT, sigma_min=1e-5, return_share=0.9, return_radius=None, limit_cost={}),
}
LAWS: dict[str, tuple[dict[str, LawCount], bool]] = {
    "none": ({}, False),
    "one": ({"anchored": LawCount(600, 590, 48, 9)}, True),
    "two": (
        {"anchored": LawCount(300, 290, 48, 5), "whole path": LawCount(400, 380, 90, 3)},
        True,
    ),
    "few starts": (
        {"anchored": LawCount(299, 290, 48, 5), "whole path": LawCount(400, 380, 90, 6)},
        True,
    ),
    "few hits": (
        {"anchored": LawCount(300, 290, 48, 5), "whole path": LawCount(400, 380, 90, 2)},
        True,
    ),
    "disagree": (
        {"anchored": LawCount(300, 290, 48, 5), "whole path": LawCount(400, 380, 90, 0)},
        False,
    ),
}
CLOSED = Bound(12.7308, 12.7309, (10, 20), (445, 445, 445), (15, 6, 3), 5.0, {(10, 20): 12.7308})
BOUNDS = {
    "none": None,
    "closed": CLOSED,
    "wide gap": replace(CLOSED, value=12.0),
    "just open": replace(CLOSED, value=12.7309 * (1.0 - 1.01e-3)),
    "few hits": replace(CLOSED, hits=(15, 2, 9)),
    "better": replace(CLOSED, found_better=True),
    "taken over": replace(CLOSED, found_better=True, replaced=12.9),
    "above": replace(CLOSED, value=12.7309 * (1.0 + 2e-5)),
    "round-off": replace(CLOSED, value=12.7309 + 1e-9),
    "cut short": replace(CLOSED, complete=False),
    "whole": replace(CLOSED, cuts=(), starts=(445,), hits=(4,), tried={(): 12.7308}),
}
CASES = list(product(LOCALS, LAWS, BOUNDS))


def findings(local: str, laws: str, bound: str) -> Findings:
    counted, agree = LAWS[laws]
    return Findings(LOCALS[local], counted, agree, BOUNDS[bound])


@pytest.mark.parametrize(("local", "laws", "bound"), CASES)
def test_verdict_sentences_and_record_of_every_combination(
    local: str, laws: str, bound: str
) -> None:
    evidence = conclude(findings(local, laws, bound))
    text = evidence.sentences
    minimum = local in {"strict", "flat", "edge"}
    if not (minimum and laws == "two"):
        expected = "local_only"
    else:
        closed = bound in {"closed", "whole", "taken over", "round-off"}
        expected = "best_known_bounded" if closed else "best_known"
    assert evidence.verdict == expected
    lines = text.split("\n")
    assert len(lines) == 3
    assert all(line[0].isupper() and line.endswith(".") for line in lines)
    # The details are read by people too.
    written = result_json(replace(answer(), evidence=evidence))["evidence"]
    shown = (text + json.dumps(written)).lower()
    assert not [word for word in FORBIDDEN if word in shown]
    bounded = bound not in {"none", "above"}
    assert bounded == ("unless" in text), "a bound comes with its condition"
    assert ("Strict local minimum" in text) == (local in {"strict", "edge"})


def test_the_record_holds_what_was_measured() -> None:
    evidence = conclude(findings("strict", "two", "closed"))
    assert evidence.local == STRICT
    assert evidence.bound == CLOSED
    assert evidence.lower_bound == 12.7308
    assert evidence.gap == pytest.approx(1e-4 / 12.7309)
    assert evidence.missed_share_95 == pytest.approx(1 - 0.05 ** (1 / 300))
    assert STRICT.costliest_joint == "arm1/joint_5"
    assert evidence.laws_agree is True
    assert evidence.stopping_rule == STOPPING_RULE
    assert evidence.stopping_rule_met is True


def test_a_bound_above_the_path_is_said_to_be_wrong_and_closes_nothing() -> None:
    evidence = conclude(findings("strict", "two", "above"))
    assert evidence.bound is not None
    assert evidence.bound.contradicted
    assert evidence.gap == pytest.approx(-2e-5)
    assert evidence.verdict == "best_known"
    assert evidence.stopping_rule_met is False
    assert evidence.sentences.split("\n")[1] == (
        "Splitting into 3 pieces: the value 12.7312 lies above this very path (gap -0.002 %), so a "
        "piece search (445 starts each, minimum hit 3 to 15 times) missed a minimum, or the bound "
        "is wrong: it bounds nothing."
    )


def test_a_bound_without_clearance_says_what_it_means_for_an_answer_with_it() -> None:
    said = replace(conclude(findings("strict", "none", "none")), sentences="Moved apart.\nMinimum.")
    with_clearance = replace(changed(answer(), objective=12.8685), evidence=said)
    evidence = with_bound_without_clearance(with_clearance, CLOSED)
    assert evidence.verdict == "local_only"
    assert evidence.lower_bound == 12.7308
    assert evidence.gap == pytest.approx(1.0 - 12.7308 / 12.8685)
    assert evidence.sentences.split("\n") == [
        "Moved apart.",
        "Without clearance, splitting into 3 pieces: no better path can exist below 12.7308 (gap "
        "0.00079 %) unless a piece search (445 starts each, minimum hit 3 to 15 times) missed a "
        "minimum. Keeping bodies apart can only raise the objective, so it bounds this answer too "
        "(gap 1.1 %). The answer lies 1.1 % above the best path known without clearance (12.7309); "
        "how much of that is needed is not known.",
        "Minimum.",
    ]
    result = replace(with_clearance, evidence=evidence)
    details = result_json(result)["evidence"]["details"]
    assert details["bound_without_clearance"] == 12.7309
    assert (
        "made without clearance, which can only raise the objective" in (details["bound_condition"])
    )
    assert not [word for word in FORBIDDEN if word in evidence.sentences.lower()]
    assert evidence.bound is not None
    higher = evidence.bound.shifted(2.0)
    assert higher.without_clearance == pytest.approx(14.7309)
    assert higher.tried == {(10, 20): pytest.approx(14.7308)}


def test_a_bound_above_a_path_without_clearance_bounds_nothing_with_it_either() -> None:
    with_clearance = changed(answer(), objective=14.0)
    evidence = with_bound_without_clearance(with_clearance, BOUNDS["above"])
    assert evidence.bound is not None
    assert evidence.bound.contradicted
    assert evidence.sentences.split("\n")[1].endswith("it bounds nothing.")


@pytest.mark.parametrize(
    ("local", "kind"),
    [("flat", "flat_minimum"), ("saddle", "saddle"), ("moving", "not_stationary")],
)
def test_the_record_tells_what_kind_of_point_it_is(local: str, kind: str) -> None:
    found = conclude(findings(local, "two", "none")).local
    assert found is not None
    assert found.kind == kind


def test_what_was_not_done_is_null() -> None:
    evidence = conclude(findings("strict", "none", "none"))
    assert evidence == Evidence(
        verdict="local_only",
        stopping_rule=STOPPING_RULE,
        stopping_rule_met=False,
        local=STRICT,
        sentences=evidence.sentences,
    )


def test_the_sentences_of_a_full_run() -> None:
    assert conclude(findings("strict", "two", "closed")).sentences == (
        "Best of 700 starts (two ways), found 5 + 3 times: better paths that these starts can "
        "reach draw under 0.99 % of them (95 %).\n"
        "Splitting into 3 pieces: no better path can exist below 12.7308 (gap 0.00079 %) unless a "
        "piece search (445 starts each, minimum hit 3 to 15 times) missed a minimum.\n"
        "Strict local minimum, 98 joint limits active, arm1/joint_5 costs most."
    )


def test_without_a_bound_the_stopping_rule_is_printed() -> None:
    assert "(1000 for a published number)" in STOPPING_RULE
    for laws, end in (("two", "; met here."), ("few hits", "; not met here.")):
        line = conclude(findings("strict", laws, "none")).sentences.split("\n")[2]
        assert STOPPING_RULE in line
        assert line.endswith(end)


@pytest.mark.parametrize(
    ("kind", "objectives", "verdict", "said"),
    [
        ("searches", (5.0, 5.0001, 5.0), "best_known", "3 of 3 independent searches found"),
        ("searches", (5.0, 5.1, 5.0), "local_only", "2 of 3 independent searches found this value"),
        ("searches", (5.0, 5.1) * 3, "best_known", "3 of 6 independent searches found"),
        ("searches", (5.0, 5.1, 5.1) * 3, "local_only", "3 of 9 independent searches found"),
        ("searches", (5.0, 5.0), "local_only", "2 of 2 independent searches"),
        ("rounds", (5.0, 5.0, 5.0), "local_only", "found by 3 rounds each by itself"),
        ("rounds", (5.2, 5.1, np.inf), "local_only", "no round alone found it"),
    ],
)
def test_searches_that_shared_nothing_speak_for_each_other(
    kind: str, objectives: tuple[float, ...], verdict: str, said: str
) -> None:
    found = Searches(kind, objectives, 5.0, 70)  # type: ignore[arg-type]
    evidence = conclude(Findings(STRICT, searches=found))
    assert evidence.verdict == verdict
    first = evidence.sentences.split("\n")[0]
    assert said in first
    if kind == "rounds" and found.hits < 2:
        assert "up to 4 % above it: expect a better one from --effort normal" in first
    kept = result_json(replace(answer(), evidence=evidence))["evidence"]["details"]["searches"]
    assert kept["hops"] == 70
    assert evidence.sentences.split("\n")[1].startswith("Strict local minimum")


def test_one_round_says_whether_it_was_enough_or_all_there_was_time_for() -> None:
    found, law = Searches("rounds", (5.0,), 5.0, 0), LawCount(200, 40, 3, 9)
    alone = conclude(Findings(STRICT, laws={"track": law}, searches=found)).sentences
    assert "all that there was time for: expect a better one from --effort normal" in alone
    both = conclude(
        Findings(STRICT, laws={"track": law, "anchored": law}, searches=found)
    ).sentences
    assert "where single points have few minima" in both


def ends(*minimum: int, converged: int | None = None) -> Solutions:
    """Return one end per number: number m is minimum m, at 0.1 m and with objective m."""
    m = np.array(minimum, dtype=float)
    ok = np.arange(len(m)) < (len(m) if converged is None else converged)
    q = np.tile(0.1 * m[:, None, None], (1, 2, 3))
    ones = np.ones(len(m), dtype=np.int64)
    return Solutions(q, m, np.zeros(len(m)), ok, ok, ones, ~ok & ok, ones)


def test_counts_of_one_law() -> None:
    law = count(Drawn(7, ends(3, 1, 1, 2, 5, 1, 3, converged=6)), np.full((2, 3), 0.1))
    assert law == LawCount(
        starts=7,
        converged=6,
        minima=4,
        best_hits=3,
        singletons=3,
        twins=0,
        second_best=2.0,
        last_improvement=2,
    )


def test_counts_weigh_ends_by_the_starts_that_led_there() -> None:
    law = count(Drawn(20, ends(1, 2, 1), np.array([4, 1, 2])), np.full((2, 3), 0.1))
    assert (law.starts, law.converged, law.best_hits, law.singletons) == (20, 7, 6, 1)
    assert law.last_improvement is None


def test_a_twin_has_the_objective_but_not_the_joints_of_the_best() -> None:
    both = ends(1, 1, 2)
    both.q[1] = -both.q[1]
    law = count(Drawn(len(both), both), np.full((2, 3), 0.1))
    assert (law.minima, law.best_hits, law.twins) == (3, 1, 1)


def test_a_law_that_found_nothing_counts_nothing() -> None:
    law = count(Drawn(2, ends(1, 2, converged=0)), np.full((2, 3), 0.1))
    assert law == LawCount(2, 0, 0, 0)
    assert law.unseen_share is None
    assert law.expected_better is None


def test_shares_of_a_law() -> None:
    law = LawCount(500, 500, 118, 4, singletons=55)
    assert law.unseen_share == pytest.approx(0.11)
    # W (N - 1) / (N - W - 2) = 118 * 499 / 380 = 154.95 minima; (154.95 - 118) / 119 = 0.31
    assert law.expected_better == pytest.approx(0.3105, abs=1e-3)
    assert LawCount(100, 100, 51, 1).expected_better == 1.0
    assert LawCount(50, 50, 48, 1).expected_better is None


def test_one_law_alone_gives_no_share_and_does_not_suffice() -> None:
    one = {"anchored": LawCount(1000, 1000, 10, 50)}
    assert missed_share(one) is None
    assert not laws_suffice(one)


def test_examine_gives_evidence_for_a_path_from_anywhere() -> None:
    evidence = examine(six_points(), minima_of_six().ends.q[0], jobs=2)
    assert evidence.verdict == "local_only"
    assert evidence.local is not None
    assert evidence.local.strict
    assert evidence.sentences.startswith("No other starts were made")


def test_examine_names_the_shape_it_wants() -> None:
    with pytest.raises(ShapeError, match=r"q: expected shape \(6, 12\), given \(5, 12\)"):
        examine(six_points(), np.zeros((5, 12)))

"""`clearance:` of a task: what it asks of each pair, and every mistake in one message."""

from __future__ import annotations

import pickle

import pytest
from paper_case import TASK

from dualarm_pin.clearance import ClearanceRule
from dualarm_pin.clearance.rule import keeps
from dualarm_pin.errors import InputError, UnknownNameError
from dualarm_pin.task import Task

WRISTS = ("arm1/link_6", "arm2/link_6")


def load(clearance: str) -> ClearanceRule | None:
    return Task.load(TASK, [f"clearance={clearance}"]).clearance


def test_the_paper_asks_nothing_and_its_sister_0_05_m() -> None:
    assert Task.load(TASK).clearance is None
    rule = Task.load(TASK.with_name("paper_corner_clear.yaml")).clearance
    assert rule is not None
    assert rule.required(WRISTS) == rule.required(WRISTS, fixed=True) == 0.05
    assert rule.between_points


def test_a_task_that_says_nothing_asks_for_no_collision_where_the_path_leaves_a_choice() -> None:
    paper = Task.load(TASK)
    for rule in (load("{}"), Task(paper.cell, paper.path).clearance):
        assert rule is not None
        assert rule.required(WRISTS) == 0.0
        assert rule.required(WRISTS, fixed=True) is None


def test_single_pairs_have_their_own_distance_in_any_order_or_none() -> None:
    rule = load(
        '{required: 0.02, pairs: {"arm2/link_6 arm1/link_6": 0.05, "arm1/link_1 arm2/link_1": off},'
        " between_points: false}"
    )
    assert rule is not None
    assert [rule.required(pair) for pair in (WRISTS, WRISTS[::-1])] == [0.05, 0.05]
    assert rule.required(("arm1/link_1", "arm2/link_1")) is None
    assert rule.required(("arm1/link_1", "arm2/link_2")) == 0.02
    assert not rule.between_points
    again = pickle.loads(pickle.dumps(rule))
    assert again == rule


def test_one_pair_alone_may_be_asked_for() -> None:
    rule = load('{required: off, pairs: {"arm1/link_6 arm2/link_6": 0.05}}')
    assert rule is not None
    assert rule.required(WRISTS) == 0.05
    assert rule.required(("arm1/link_1", "arm2/link_2")) is None
    assert load("{required: off}") is None


def test_contact_is_never_enough_and_a_hair_less_than_asked_is() -> None:
    assert not keeps(0.0, 0.0)
    assert keeps(1e-6, 0.0)
    assert keeps(0.0499, 0.05)
    assert not keeps(0.049, 0.05)


@pytest.mark.parametrize(
    ("clearance", "field", "message"),
    [
        ("-0.1", "clearance", "0 or more"),
        ("{required: -0.1}", "clearance.required", "0 or more"),
        ("{required: .nan}", "clearance.required", "0 or more"),
        ("{pairs: {a: -1}}", "clearance.pairs.a", "0 or more"),
        ("{requird: 1}", "clearance.requird", "did you mean 'required'"),
        ("on", "clearance", "or off is expected"),
        (
            '{pairs: {"arm1/link_6": 1}}',
            "clearance.pairs.arm1/link_6",
            "given one, 'arm1/link_6': name",
        ),
        ('{pairs: {"arm1/link_6 arm2/link6": 1}}', "link6", "did you mean 'arm2/link_6'?"),
        ('{pairs: {"arm1/link_6 arm1/link_6": 1}}', "pairs", "one body twice"),
        (
            '{pairs: {"arm1/link_6 arm2/link_6": 1, "arm2/link_6 arm1/link_6": 1}}',
            "pairs",
            "in both orders",
        ),
    ],
)
def test_a_mistake_is_one_message_with_its_field(clearance: str, field: str, message: str) -> None:
    with pytest.raises(InputError) as error:
        load(clearance)
    assert field in str(error.value.field)
    assert message in str(error.value)
    assert error.value.file is not None


def test_python_gets_the_same_answers(task: Task) -> None:
    with pytest.raises(InputError, match="0 or more"):
        ClearanceRule(-1.0)
    with pytest.raises(UnknownNameError, match="did you mean 'arm1/link_6'"):
        Task(task.cell, task.path, clearance=ClearanceRule(pairs={("arm1/link6", "world"): 0.1}))

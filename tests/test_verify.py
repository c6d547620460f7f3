"""What every answer says of itself: checked point by point, with the time that it took."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
from answers import answer, task

from dualarm_pin.answer.summary import summary
from dualarm_pin.planners.whole_path import plan_global, polish
from dualarm_pin.solvers import interior_point as engine


def test_each_point_has_its_closest_pair_of_links() -> None:
    t = answer()
    for distances, between_arms in ((t.checked.clearance, False), (t.checked.arm_clearance, True)):
        assert distances is not None
        for q, distance, pair in zip(t.q, distances.distance, distances.pairs, strict=True):
            alone = task().cell.clearance(q, between_arms=between_arms)
            assert alone is not None
            assert distance == pytest.approx(alone.distance, abs=1e-9)
            assert pair == (alone.first, alone.second)
        worst = int(np.argmin(distances.distance))
        assert distances.closest == distances.pairs[worst]
        assert distances.least == distances.distance[worst]
    assert t.checked.arm_clearance is not None
    assert {name[:5] for pair in t.checked.arm_clearance.pairs for name in pair} == {
        "arm1/",
        "arm2/",
    }


@pytest.mark.parametrize(
    "planner",
    [
        lambda: plan_global(task(), effort="quick", seed=0, jobs=1),
        lambda: polish(task(), answer().q),
    ],
    ids=["global", "polish"],
)
def test_compiling_is_a_part_of_the_wall_seconds(
    planner: Callable[[], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`... s wall, ... s of it compiling`: so the clock starts before."""

    def slow(say: object = None) -> float:
        time.sleep(5.0)
        return 5.0

    engine.ensure_compiled()
    monkeypatch.setattr(engine, "ensure_compiled", slow)
    found = planner()
    assert found.timing.compile_s == 5.0  # type: ignore[attr-defined]
    assert found.timing.wall_s > 5.0  # type: ignore[attr-defined]
    assert ", 5.0 s of it compiling" in summary(task(), found)  # type: ignore[arg-type]

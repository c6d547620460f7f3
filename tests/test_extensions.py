"""What a user adds: an index, a row, a path, a solver, a planner, each here and nowhere else.

Each is used from Python and from a task file that names it with `call: module:function`, beside a
file whose module holds the same few lines.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from commands import Run
from paper_case import world_pose
from patience import LONG

import dualarm_pin as dp

MINE = '''
import numpy as np
import dualarm_pin as dp
from dualarm_pin.reference import equalities


def press(weight=1.0):
    """An index: push along the path, and press on the part."""
    def phi(A, u):
        return np.dot(u, np.dot(A, u)) + weight * A[2, 2]
    return dp.indices.custom("press", phi)


def apart(distance):
    """A row: the tips stay at least so far from each other, squared so that it is smooth."""
    def phi(R, p, parameters):
        return np.dot(p, p) - parameters[0] ** 2
    return dp.rows.Row("tips apart", "arm1/tip", "arm2/tip", phi, parameters=[distance])


def level(**how):
    """A row in the world: hand 1 at one height, an equality."""
    def phi(R, p, parameters):
        return p[2] - parameters[0]
    return dp.rows.Row("level", "world", "arm1/tip", phi, parameters=[0.7], equality=True, **how)


def zigzag(width, *, height=0.3, points=5, **how):
    """A path: to and fro along x."""
    x = width * (np.arange(points) % 2)
    y = 0.01 * np.arange(points)
    position = np.column_stack([x, y, np.full(points, height)])
    return dp.Path(position, np.diag([1.0, -1.0, -1.0]), name="zigzag")


class Descent:
    """A solver: Gauss-Newton onto the path and nothing else."""

    name = "descent"

    def __init__(self, steps=20):
        self.steps = steps

    def __call__(self, problem, start):
        q = np.clip(start, problem.lower, problem.upper)
        for _ in range(self.steps):
            for i in range(problem.k):
                r, J = equalities(problem, i, dp.Relative(problem.cell, q[i]))
                q[i] = np.clip(q[i] - np.linalg.pinv(J) @ r, problem.lower, problem.upper)
        return dp.solvers.judged(problem, q, converged=True)


def descent(problem, start, steps=20):
    """The same solver as a function."""
    return Descent(steps)(problem, start)


def local_polished(task, seed=0, k0=1.0):
    """A planner variant."""
    return dp.polish(task, dp.plan_local(task, seed=seed, k0=k0).q)


def stepwise(task, seed=0):
    """Another one, for any index at once."""
    return dp.plan_local(task, seed=seed)


def broken(*arguments, **more):
    raise ZeroDivisionError("by zero")


def nothing(*arguments, **more):
    return 7
'''
CELL = dp.urdf_folder() / "cells" / "ns16_pair.yaml"
CORNER = "{corner: {points: [2, 1, 2]}}"


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with the module of a user, and no trace of it afterwards."""
    (tmp_path / "my_code.py").write_text(MINE)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield tmp_path
    sys.modules.pop("my_code", None)


def write(folder: Path, path: str = CORNER, **keys: str) -> Path:
    file = folder / "task.yaml"
    lines = [f"cell: {CELL}", f"path: {path}", *(f"{k}: {v}" for k, v in keys.items())]
    file.write_text("\n".join(lines) + "\n")
    return file


def own(folder: Path) -> dict[str, object]:
    space: dict[str, object] = {"__name__": "here"}
    exec(MINE, space)
    return space


def task_in_python(**more: object) -> dp.Task:
    return dp.Task(dp.Cell.load(CELL), dp.paths.corner(points=(2, 1, 2)), **more)  # type: ignore[arg-type]


def test_an_index(mine: Path) -> None:
    file = write(mine, index='{call: "my_code:press", weight: 2, joint_centre: 0.1}')
    loaded = dp.Task.load(file, allow_code=True)
    assert (loaded.index.name, loaded.index.joint_centre) == ("press", 0.1)
    press = own(mine)["press"]
    task = task_in_python(index=press(2.0).with_joint_centre(0.1))  # type: ignore[operator]
    here, there = dp.plan_local(task), dp.plan_local(loaded)
    assert here.found and there.objective == pytest.approx(here.objective)
    best = dp.plan_global(loaded, effort="quick")
    assert best.found and best.objective < there.objective


def test_an_index_along_a_direction(mine: Path) -> None:
    file = write(mine, index='{call: "my_code:press", direction: [0, 0, 2]}')
    assert dp.Task.load(file, allow_code=True).path.u[0].tolist() == [0, 0, 1, 0, 0, 0]


def test_a_row(mine: Path) -> None:
    space = own(mine)
    rows = (space["apart"](0.1), space["level"]())  # type: ignore[operator]
    python = dp.plan_global(task_in_python(rows=rows), effort="quick", seed=0)
    calls = "[{call: 'my_code:apart', distance: 0.1}, {call: 'my_code:level', points: [2, 4]}]"
    task = dp.Task.load(write(mine, constraints=calls), allow_code=True)
    assert [row.name for row in task.rows] == ["tips apart", "level"]
    assert task.rows[1].points == (1, 3)
    file = dp.plan_global(task, effort="quick", seed=0)
    assert python.found
    assert file.found
    assert np.abs(python.checked.rows[1].value).max() < 1e-6
    heights = [p.translation[2] for p in (_tip(task, q) for q in file.q)]
    np.testing.assert_allclose([heights[1], heights[3]], 0.7, atol=1e-6)
    assert abs(heights[0] - 0.7) > 1e-4
    assert file.objective < python.objective


def _tip(task: dp.Task, q: np.ndarray) -> object:
    return world_pose(task, "arm1/tip", q)


def test_a_path(mine: Path) -> None:
    file = write(mine, '{call: "my_code:zigzag", width: 0.1, points: 4, free: spin}')
    loaded = dp.Task.load(file, allow_code=True)
    expected = own(mine)["zigzag"](0.1, points=4)  # type: ignore[operator]
    np.testing.assert_array_equal(loaded.path.position, expected.position)
    assert dp.plan_local(loaded).found


TYPED = """
from typing import Unpack

from dualarm_pin.path.generators.arguments import Angle
from dualarm_pin.path.generators.follow import Follow
from dualarm_pin.path.paths import arc


def half(radius: float, turn: Angle, **how: Unpack[Follow]):
    return arc(radius, 0.0, turn, **how)
"""


def test_a_path_with_a_typed_signature_is_checked_like_ours(mine: Path) -> None:
    (mine / "my_typed.py").write_text(TYPED)
    good = 'call: "my_typed:half", radius: 0.1, turn_deg: 90, points: 5, rpy_deg: [180, 0, 0]'
    path = dp.Task.load(write(mine, f"{{{good}}}"), allow_code=True).path
    assert path.length == pytest.approx(0.1 * np.pi / 2)
    np.testing.assert_allclose(path.rotation[0], np.diag([1.0, -1.0, -1.0]), atol=1e-12)
    for given, message in {
        "turn_degs: 90, points: 5, turn_deg: 9": "path.turn_degs: unknown key: did you mean 'turn_",
        "turn_deg: 90": "path: give one of points and step: neither is given",
        "points: 5": "path.turn_deg: this key is missing",
        "turn_deg: 0, points: 5": "path.call: my_typed:half: stop: the arc has no length",
        "turn_deg: 90, points: 5, free: spinning": "task.yaml:2: path.free",
    }.items():
        file = write(mine, f'{{call: "my_typed:half", radius: 0.1, {given}}}')
        with pytest.raises(dp.DualArmError, match=message):
            dp.Task.load(file, allow_code=True)


@pytest.mark.parametrize("solver", ["Descent", "descent"])
def test_a_solver(mine: Path, solver: str) -> None:
    given = own(mine)[solver]
    given = given(20) if isinstance(given, type) else given
    task = task_in_python()
    here = dp.plan_global(task, effort="quick", solver=given, starts=4)  # type: ignore[arg-type]
    assert here.found and here.solver == getattr(given, "name", "descent")
    file = write(mine, solver=f'{{call: "my_code:{solver}", steps: 20}}')
    there = dp.plan(dp.Task.load(file, allow_code=True), "global", effort="quick", starts=4)
    assert there.found and there.solver == f"my_code:{solver}"
    np.testing.assert_allclose(there.q, here.q)


@pytest.mark.parametrize("jobs", [1, 2])
def test_two_stages_take_a_solver_too(mine: Path, jobs: int) -> None:
    file = write(
        mine, solver='{call: "my_code:descent", steps: 20}', two_stage="{Gamma: [1, 3, 5]}"
    )
    answer = dp.plan(dp.Task.load(file, allow_code=True), "two-stage", starts=4, jobs=jobs)
    assert answer.found and answer.solver == "my_code:descent"
    shipped = dp.plan_two_stage(
        task_in_python(), starts=4, jobs=1, solver=dp.solvers.InteriorPoint()
    )
    assert shipped.found and shipped.solver == "engine"
    assert shipped.objective < answer.objective


@pytest.mark.parametrize("solver", [dp.solvers.Slsqp(), dp.solvers.Casadi("ipopt")])
def test_the_shipped_solvers_stay_at_a_minimum_or_find_a_better_one(
    solver: dp.solvers.Solver,
) -> None:
    if isinstance(solver, dp.solvers.Casadi):
        pytest.importorskip("casadi")
    task = task_in_python()
    best = dp.plan_global(task, effort="quick", seed=0)
    end = solver(task.problem(), best.q)
    assert end.feasible
    assert end.objective <= best.objective * (1.0 + 1e-5)
    assert dp.polish(task, best.q, solver=solver).solver == solver.name  # type: ignore[attr-defined]


def test_a_planner(mine: Path) -> None:
    planner = own(mine)["local_polished"]
    here = dp.plan(task_in_python(), planner)  # type: ignore[arg-type]
    file = write(mine, method='{call: "my_code:local_polished", k0: 1.0}')
    there = dp.plan(dp.Task.load(file, allow_code=True))
    assert here.found and there.objective == pytest.approx(here.objective)


def test_the_method_and_the_solver_of_a_file_may_be_names(mine: Path) -> None:
    task = dp.Task.load(write(mine, method="local", solver="clamped"))
    assert dp.plan(task).solver == "pseudo-inverse-clamped"
    with pytest.raises(dp.DualArmError, match="unknown solver 'clamped'"):
        dp.plan(task, "global")


CALLS = {
    "index": 'index: {call: "touch:it", weight: 2}',
    "method": 'method: {call: "touch:it"}',
    "solver": 'solver: {call: "touch:it"}',
    "row": 'constraints: [{call: "touch:it"}]',
}


@pytest.mark.parametrize("line", CALLS.values(), ids=CALLS)
@pytest.mark.parametrize("command", ["solve", "check"])
def test_nothing_is_imported_unless_it_is_allowed(
    tmp_path: Path, line: str, command: str, run: Run
) -> None:
    (tmp_path / "touch.py").write_text("from pathlib import Path\nPath('touched').touch()\n")
    file = write(tmp_path)
    file.write_text(file.read_text() + line + "\n")
    done = run(command, file, cwd=tmp_path)
    assert done.returncode == 2
    [message] = done.stderr.strip().splitlines()
    assert f"{file}:3: " in message and ".call: " in message
    assert f"import the module 'touch' from {tmp_path / 'touch.py'} and call 'it'" in message
    assert "--allow-code" in message and "allow_code=True" in message
    assert not (tmp_path / "touched").exists()


def test_a_call_by_set_and_one_in_a_path_are_refused_too(tmp_path: Path) -> None:
    with pytest.raises(dp.DualArmError, match=r"path\.call: it would import the module 'a\.b'"):
        dp.Task.load(write(tmp_path, '{call: "a.b:c"}'))
    with pytest.raises(dp.DualArmError, match=r"index\.call: it would import the module 'os'"):
        dp.Task.load(write(tmp_path), ['index.call="os:system"', 'index.command="true"'])


def test_a_suite_is_refused_as_a_whole(tmp_path: Path, run: Run) -> None:
    task = write(tmp_path, index='{call: "my_code:press"}')
    suite = tmp_path / "suite.yaml"
    for text, field in {
        f"{{tasks: [{task}], methods: [local]}}": "index.call",
        "{tasks: [x], methods: [{call: 'a:b'}]}": "methods.0.call",
    }.items():
        suite.write_text(text)
        done = run("bench", suite, cwd=tmp_path)
        assert done.returncode == 2
        assert field in done.stderr and "--allow-code" in done.stderr


def test_the_workers_of_a_suite_run_what_is_allowed(mine: Path, run: Run) -> None:
    task = write(mine, index='{call: "my_code:press"}')
    suite = mine / "suite.yaml"
    suite.write_text(f"{{tasks: [{task}], methods: [local]}}")
    done = subprocess.run(
        [sys.executable, "-m", "dualarm_pin", "bench", suite, "--allow-code", "--out", "out"],
        cwd=mine, capture_output=True, text=True, timeout=LONG, check=False,
    )  # fmt: skip
    assert "1 ok" in done.stdout, done.stdout + done.stderr
    first = run("bench", suite, "--allow-code", "--out", "out", "--resume", cwd=mine)
    assert "1 ok" in first.stdout


WRONG = {
    "no module": ('{call: "my_cod:press"}', "index.call: there is no module 'my_cod' in "),
    "no function": ('{call: "my_code:pres"}', "has no function 'pres': did you mean 'press'"),
    "no such key": ('{call: "my_code:press", wight: 2}', "index.wight: unknown key: did you mean"),
    "it raises": ('{call: "my_code:broken"}', "index.call: my_code:broken: it raised ZeroDiv"),
    "another thing": ('{call: "my_code:nothing"}', "a Index is expected; it returned 7"),
    "not two parts": ('{call: "my_code"}', "index.call: "),
    "import fails": ('{call: "my_bad:f"}', "importing 'my_bad': it raised ValueError: bad"),
    "its import": ('{call: "my_lost:f"}', "importing 'my_lost': No module named 'not_there'"),
}  # fmt: skip


@pytest.mark.parametrize(("index", "message"), WRONG.values(), ids=WRONG)
def test_a_mistake_names_file_line_and_field(mine: Path, index: str, message: str) -> None:
    (mine / "my_bad.py").write_text("raise ValueError('bad')\n")
    (mine / "my_lost.py").write_text("import not_there\n")
    file = write(mine, index=index)
    with pytest.raises(dp.DualArmError) as caught:
        dp.Task.load(file, allow_code=True)
    assert str(caught.value).startswith(f"{file}:3: index.")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("key", "call", "message"),
    [
        ("solver", "broken", "solver.call: my_code:broken: it raised ZeroDivisionError: by zero"),
        ("solver", "nothing", "solver.call: my_code:nothing: a Solution with q of shape"),
        ("method", "broken", "method.call: my_code:broken: it raised ZeroDivisionError"),
        ("method", "nothing", "method.call: my_code:nothing: a Trajectory is expected"),
    ],
)  # fmt: skip
def test_a_mistake_while_planning_is_one_message(
    mine: Path, key: str, call: str, message: str, run: Run
) -> None:
    file = write(mine, **{key: f'{{call: "my_code:{call}"}}'})
    done = run("solve", file, "--allow-code", "--effort", "quick", cwd=mine)
    assert done.returncode == 2, done.stderr
    assert f"{file}:3: {message}" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (mine / "results").exists()


def test_two_modules_of_one_name_are_told_apart(mine: Path) -> None:
    dp.Task.load(write(mine, index='{call: "my_code:press"}'), allow_code=True)
    other = mine / "other"
    other.mkdir()
    (other / "my_code.py").write_text(MINE)
    with pytest.raises(dp.DualArmError, match="two have this name, rename yours"):
        dp.Task.load(write(other, index='{call: "my_code:press"}'), allow_code=True)


def test_a_result_keeps_its_call_and_asks_again(mine: Path, run: Run) -> None:
    file = write(mine, index='{call: "my_code:press"}', method='{call: "my_code:stepwise"}')
    done = run("solve", file, "--allow-code", "--out", "r", cwd=mine)
    assert done.returncode == 0, done.stderr
    saved = (mine / "r" / "task.yaml").read_text()
    assert "my_code:press" in saved and "my_code:stepwise" in saved and str(mine) in saved
    refused = run("view", "r", "--html", "page.html", cwd=mine)
    assert refused.returncode == 2 and "index.call" in refused.stderr
    shown = run("view", "r", "--html", "page.html", "--allow-code", cwd=mine)
    assert shown.returncode == 0, shown.stderr
    # The method and the solver have done their work: such a result is seen without more ado.
    file = write(mine, method='{call: "my_code:stepwise"}')
    assert run("solve", file, "--allow-code", "--out", "s", cwd=mine).returncode == 0
    assert json.loads((mine / "s" / "result.json").read_text())["found"]
    assert run("view", "s", "--html", "page.html", cwd=mine).returncode == 0

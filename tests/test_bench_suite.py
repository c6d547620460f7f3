"""Suite files: what they expand to, what they refuse."""

from pathlib import Path

import pytest
from paper_case import TASK

from dualarm_pin.bench.gates import read_gate
from dualarm_pin.bench.run import variant_name
from dualarm_pin.bench.suite import Suite
from dualarm_pin.errors import InputError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.files.suite_spec import GateEntry, StepsSpec


def suite(folder: Path, text: str) -> Suite:
    file = folder / "suite.yaml"
    file.write_text(text.replace("TASK", str(TASK)))
    return Suite.load(file)


def test_a_suite_is_the_product_of_tasks_variants_methods_and_seeds(tmp_path):
    got = suite(
        tmp_path,
        """
tasks: [TASK]
methods: [global, {method: two-stage, starts: 3, seeds: [7], time_limit: 5}]
seeds: 2
overrides:
  grid: {smoothness: [1.0, 3.0], cell.arms.arm2.base.xyz.0: {first: 2.4, last: 2.6, count: 3}}
  variants: [{index: force}, {index: force, path.corner.side: 0.12}]
""",
    )
    assert len(got.runs) == 2 * 3 * 2 * (2 + 1)
    assert len({run.key for run in got.runs}) == len(got.runs)
    assert {run.method.name for run in got.runs} == {"global", "two-stage 3 starts"}
    assert {run.time_limit for run in got.runs if run.method.planner == "two-stage"} == {5.0}
    last = got.runs[-1]
    assert last.overrides == {
        "smoothness": 3.0,
        "cell.arms.arm2.base.xyz.0": 2.6,
        "index": "force",
        "path.corner.side": 0.12,
    }
    assert variant_name(last.overrides).startswith("smoothness=3.0, cell.arms.arm2.base.xyz.0=2.6")


def test_a_key_depends_on_what_defines_the_run_and_not_on_names_or_places(tmp_path):
    def key(text: str, folder: str) -> str:
        (tmp_path / folder).mkdir()
        return suite(tmp_path / folder, text).runs[0].key

    plain = key("{tasks: [TASK], methods: [global]}", "a")
    assert (
        key("{tasks: [{file: TASK, name: x}], methods: [{method: global, name: y}]}", "b") == plain
    )
    others = [
        key("{tasks: [TASK], methods: [{method: global, effort: quick}]}", "c"),
        key("{tasks: [TASK], methods: [global], seeds: [1]}", "d"),
        key("{tasks: [TASK], methods: [global], time_limit: 3}", "e"),
        key("{tasks: [TASK], methods: [global], overrides: {grid: {smoothness: [4]}}}", "f"),
        key("{tasks: [TASK], methods: [global], overrides: {grid: {cell.lock: [{}]}}}", "g"),
    ]
    assert len({plain, *others}) == 6


def test_a_key_depends_on_the_bytes_of_the_robots(tmp_path):
    for name in ("ns16", "cells", "tasks"):
        (tmp_path / name).symlink_to(urdf_folder() / name)
    (tmp_path / "ns16").unlink()
    (tmp_path / "ns16").mkdir()
    (tmp_path / "ns16" / "meshes").symlink_to(urdf_folder() / "ns16" / "meshes")
    (tmp_path / "cells").unlink()
    (tmp_path / "cells").mkdir()
    cell = (urdf_folder() / "cells" / "ns16_pair.yaml").read_text()
    (tmp_path / "cells" / "ns16_pair.yaml").write_text(cell)
    (tmp_path / "tasks").unlink()
    (tmp_path / "tasks").mkdir()
    (tmp_path / "tasks" / "corner.yaml").write_text(TASK.read_text())
    urdf = tmp_path / "ns16" / "ns16.urdf"
    original = (urdf_folder() / "ns16" / "ns16.urdf").read_bytes()
    file = tmp_path / "suite.yaml"
    file.write_text("{tasks: [tasks/corner.yaml], methods: [global]}")
    urdf.write_bytes(original)
    first = Suite.load(file).runs[0]
    assert any(name.endswith(".stl") for name in first.inputs.robots)
    urdf.write_bytes(original.replace(b"</robot>", b"</robot><!-- another -->"))
    assert Suite.load(file).runs[0].key != first.key


def test_globs_name_tasks_by_their_files(tmp_path):
    for name, smoothness in (("one", "1.0"), ("two", "2.0")):
        text = TASK.read_text().replace("../cells", str(urdf_folder() / "cells"))
        text = text.replace("smoothness: 3.0", f"smoothness: {smoothness}")
        (tmp_path / f"{name}.task.yaml").write_text(text)
    got = suite(tmp_path, "{tasks: ['*.task.yaml'], methods: [local]}")
    assert [run.task for run in got.runs] == ["one.task", "two.task"]


def test_steps_include_both_ends():
    assert StepsSpec(first=0.1, last=0.3, count=3).values == [0.1, 0.2, 0.3]


BAD = [
    ("{tasks: [TASK], methods: [globall]}", 1, "methods.0", "did you mean 'global'?"),
    ("tasks: [TASK]\nmethods:\n- {method: global, solver: x}", 3, "methods.0.solver", "unknown"),
    ("tasks: [TASK]\nmethods:\n- {method: global, effort: no}", 3, "methods.0.effort", "unknown"),
    ("tasks: [nowhere.yaml]\nmethods: [local]", 1, "tasks.0", "file does not exist: nowhere.yaml"),
    ("tasks: ['no*.yaml']\nmethods: [local]", 1, "tasks.0", "glob matches no file"),
    ("tasks: [TASK]\nmethods: [local]\nseed: 3", 3, "seed", "did you mean 'seeds'?"),
    ("tasks: [TASK]\nmethods: [local]\ntime_limit: 0", 3, "time_limit", "greater than 0"),
    ("tasks: [TASK]\nmethods: []", 2, "methods", "at least 1"),
    ("methods: [local]", 1, "tasks", "missing"),
    ("tasks: [TASK]\nmethods: [local, local]", 2, "methods.1", "two methods are called 'local'"),
    (
        "tasks: [TASK]\nmethods: [local, {method: local, name: x}]",
        1,
        "tasks.0",
        "the same run as",
    ),
    ("tasks: [TASK]\nmethods: [{call: nonsense}]", 2, "methods.0.call", "pattern"),
    ("tasks: [TASK]\nmethods: [{name: x}]", 2, "methods.0", "either a `method` or a function"),
    ("tasks: [TASK]\nmethods: [local]\ngates: [mean_index]", 3, "gates.0", "not a condition"),
    (
        "tasks: [TASK]\nmethods: [local]\ngates:\n- {gate: mean_index < 1, method: globl}",
        4,
        "gates.0",
        "no method of this suite is called 'globl'",
    ),
    (
        "tasks: [TASK]\nmethods: [local]\noverrides: {grid: {smoothness: []}}",
        3,
        "overrides.grid.smoothness",
        "at least 1",
    ),
    (
        "tasks: [TASK]\nmethods: [local]\nmaps: [{x: a, y: b}]",
        3,
        "maps.0",
        "'a' is no key of overrides.grid",
    ),
]


@pytest.mark.parametrize(("text", "line", "field", "message"), BAD)
def test_a_bad_suite_is_refused_with_file_line_and_field(tmp_path, text, line, field, message):
    with pytest.raises(InputError) as caught:
        suite(tmp_path, text)
    assert str(caught.value).startswith(f"{tmp_path / 'suite.yaml'}:{line}: {field}: ")
    assert message in str(caught.value)


def test_a_bad_override_names_the_key(tmp_path):
    with pytest.raises(InputError, match=r"smothness.*did you mean 'smoothness'"):
        suite(tmp_path, "{tasks: [TASK], methods: [local], overrides: {grid: {smothness: [1]}}}")


def rows(*values):
    base = {"task": "t", "method": "m", "seed": 0, "status": "ok"}
    return [base | {"mean_index": value} for value in values]


@pytest.mark.parametrize(
    ("text", "of", "values", "holds"),
    [
        ("mean_index <= 0.41", "every", (0.40, 0.41), True),
        ("mean_index <= 0.41", "every", (0.40, 0.42), False),
        ("mean_index <= 0.41", "best", (0.40, 0.42, None), True),
        ("mean_index >= 0.41", "best", (0.40, 0.42), True),
        ("mean_index <= 0.41", "median", (0.40, 0.41, 9.0), True),
        ("mean_index <= 0.41", "mean", (0.40, 9.0), False),
        ("mean_index <= 0.41", "every", (0.40, None), False),
        ("nothing <= 1", "best", (0.40,), False),
        ("mean_index == true", "every", (1.0,), True),
    ],
)
def test_gates(text, of, values, holds):
    gate = read_gate(GateEntry(gate=text, of=of), ["t"], ["m"])
    assert (gate.failure(rows(*values)) is None) == holds


def test_a_gate_without_a_run_does_not_hold():
    gate = read_gate(GateEntry(gate="mean_index < 1", task="t*"), ["t"], ["m"])
    assert gate.failure([]) == "no run to judge"


@pytest.mark.parametrize(("name", "runs"), [("paper", 25), ("placement", 90), ("cells", 108)])
def test_the_suites_that_ship_are_right(name, runs):
    if name == "cells":
        from dualarm_pin.robot.packages import robot_data_share

        if robot_data_share() is None:
            pytest.skip("needs the extra `robots`")
    shipped = Suite.load(urdf_folder() / "suites" / f"{name}.yaml")
    assert len(shipped.runs) == runs
    assert shipped.spec.limitations

"""`import dualarm_pin as dp`: the names that users need, each on demand, and no others."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import dualarm_pin as dp

NAMES = """
Cell DualArmError Path Relative Task Trajectory __version__ clearance examine export indices
load_result make_motion paths plan plan_global plan_local plan_placement plan_two_stage polish rows
save_result show solvers urdf_folder verified verify
""".split()
HEAVY = {"numba", "matplotlib", "meshcat", "scipy", "distributed", "casadi", "pink", "rich"}


def test_autocomplete_shows_these_names_and_nothing_else() -> None:
    assert dir(dp) == sorted(NAMES)
    assert sorted(dp.__all__) == sorted(NAMES)
    assert len(NAMES) <= 27


@pytest.mark.parametrize("name", NAMES)
def test_every_name_is_there(name: str) -> None:
    assert getattr(dp, name) is not None


def test_another_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'plan_globally'"):
        _ = dp.plan_globally


def test_type_checkers_see_the_same_names() -> None:
    tree = ast.parse(Path(dp.__file__).read_text(encoding="utf-8"))
    [block] = [node for node in tree.body if isinstance(node, ast.If)]
    seen = [
        alias.asname or alias.name
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    assert sorted([*seen, "__version__"]) == sorted(NAMES)


def loaded_by(statement: str) -> set[str]:
    """Return the modules that a fresh process holds after `statement`."""
    code = f"{statement}\nimport sys\nprint(*sorted(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    return set(done.stdout.split())


def test_the_import_loads_nothing_of_the_package() -> None:
    loaded = loaded_by("import dualarm_pin as dp; dir(dp)")
    assert {name for name in loaded if name.startswith("dualarm_pin")} == {"dualarm_pin"}
    assert not loaded & (HEAVY | {"numpy", "pinocchio", "pydantic"})


@pytest.mark.parametrize(
    "names", ["dp.plan_global", "dp.Task, dp.Cell, dp.paths.corner, dp.indices.force, dp.solvers"]
)
def test_what_a_plan_needs_loads_no_compiler_viewer_or_plot(names: str) -> None:
    assert not loaded_by(f"import dualarm_pin as dp; {names}") & HEAVY


def test_one_planner_does_not_load_the_others() -> None:
    loaded = loaded_by("import dualarm_pin as dp; dp.plan_global")
    assert not loaded & {"nlopt", "quadprog", "dualarm_pin.planners.local"}

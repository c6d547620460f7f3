"""Imports run down the floors, and importing the package stays light."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "dualarm_pin"
FLOORS = {
    7: {"cli", "__main__"},
    6: {"bench", "show", "paper", "inspection"},
    5: {"planners"},
    4: {"search", "evidence"},
    3: {"task", "problem", "solvers", "answer"},
    2: {"indices", "constraints", "engine"},
    1: {"cell", "meshes", "path", "relative", "robot"},
    0: {"errors", "tolerance", "files", "arrays", "progress", "cpp_messages", "__init__"},
}
FLOOR = {noun: floor for floor, nouns in FLOORS.items() for noun in nouns}
MODULES = sorted(PACKAGE.rglob("*.py"))


def noun_of(module: str) -> str:
    """Return the noun that a dotted module belongs to."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


def imported(file: Path) -> set[str]:
    """Return the modules of this package that a file imports, wherever in the file."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            if node.module == "dualarm_pin":
                found |= {f"dualarm_pin.{alias.name}" for alias in node.names}
            elif node.module.startswith("dualarm_pin."):
                found.add(node.module)
        elif isinstance(node, ast.Import):
            found |= {a.name for a in node.names if a.name.startswith("dualarm_pin")}
    return found


@pytest.mark.parametrize("file", MODULES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_a_module_imports_only_from_its_floor_or_below(file: Path) -> None:
    relative = file.relative_to(PACKAGE).with_suffix("")
    if relative.parts[0] == "urdf":
        return
    own = relative.parts[0]
    assert own in FLOOR, f"{own} has no floor: give it one in this test"
    for module in imported(file):
        noun = noun_of(module)
        if noun not in FLOOR:  # a name of the package itself, such as __version__
            assert noun.startswith("__"), f"{module} has no floor"
            continue
        assert FLOOR[noun] <= FLOOR[own], f"{own} imports {module} from a floor above"


def loaded_by(statement: str) -> set[str]:
    """Return the modules that a fresh process holds after `statement`."""
    code = f"{statement}\nimport sys\nprint(*sorted(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    return set(done.stdout.split())


HEAVY = {"numba", "matplotlib", "meshcat", "plotly", "scipy", "pinocchio", "distributed"}


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert not HEAVY & loaded_by("import dualarm_pin")


def test_help_loads_nothing_heavy() -> None:
    statement = (
        "from dualarm_pin.cli import app\n"
        "import contextlib, io\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        "    app(['--help'])"
    )
    assert not HEAVY & loaded_by(statement)


def test_loading_a_task_needs_no_viewer_plot_or_compiler() -> None:
    loaded = loaded_by("import dualarm_pin.task, dualarm_pin.planners.methods")
    assert not {"numba", "matplotlib", "meshcat", "plotly"} & loaded

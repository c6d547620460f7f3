"""Imports run down the floors and never in a circle, and importing the package stays light."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from import_graph import Graph, circles, import_graph
from patience import LONG

PACKAGE = Path(__file__).resolve().parents[1] / "dualarm_pin"
# From the roof down. A room imports from its own floor or below it; on one floor one way only.
FLOORS = [
    {"cli", "__main__"},
    {"bench", "paper", "inspection", "second_opinion", "explain", "starter", "design"},
    {"planners", "show", "exports"},
    {"feed"},
    {"evidence"},
    {"motion"},
    {"search", "answer", "repair"},
    {"task", "solvers"},
    {"engine"},
    {"problem", "placement"},
    {"reference"},
    {"rows", "indices", "clearance"},
    {"chain", "solution"},
    {"cell", "path"},
    {"relatives", "relative", "meshes"},
    {"robot"},
    {"files", "arrays"},
    {"errors", "tolerance", "progress", "cpp_messages", "__init__"},
]
HEIGHT = {room: height for height, rooms in enumerate(reversed(FLOORS)) for room in rooms}


def room_of(module: str) -> str:
    """Return the room that a dotted module belongs to; the package itself is `__init__`."""
    return [*module.split("."), "__init__"][1]


def rooms_of(graph: Graph) -> Graph:
    """Return which rooms each room imports."""
    rooms: Graph = {}
    for module, others in graph.items():
        rooms.setdefault(room_of(module), set()).update(room_of(other) for other in others)
    return {room: others - {room} for room, others in rooms.items()}


def climbs(graph: Graph) -> list[str]:
    """Return every import from a floor above, as a sentence."""
    return [
        f"{module} imports {other} from a floor above"
        for module, others in graph.items()
        for other in sorted(others)
        if HEIGHT[room_of(other)] > HEIGHT[room_of(module)]
    ]


@pytest.fixture(scope="module")
def graph() -> Graph:
    return import_graph(PACKAGE)


def test_every_room_has_a_floor(graph: Graph) -> None:
    missing = set(rooms_of(graph)) - set(HEIGHT)
    assert not missing, f"{missing} have no floor: give them one in this test"


def test_a_module_imports_only_from_its_floor_or_below(graph: Graph) -> None:
    assert climbs(graph) == []


def test_no_modules_import_each_other_around(graph: Graph) -> None:
    assert circles(graph) == []


def test_no_rooms_import_each_other_around(graph: Graph) -> None:
    assert circles(rooms_of(graph)) == []


HOUSE = {
    "__init__.py": "",
    "cell/__init__.py": "from house.cell.cell import Cell",
    "cell/cell.py": "def load():\n    from house.cell import build\n    return build",
    "cell/build.py": "import house.cell.entry",
    "cell/entry.py": "from .cell import Cell",
    "answer.py": "from house.cell import Cell",
    "path.py": (
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from house.task import Task\n"
        "else:\n    import house.answer"
    ),
    "task.py": "import house.path",
}


@pytest.fixture
def house(tmp_path: Path) -> Path:
    for name, text in HOUSE.items():
        file = tmp_path / "house" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return tmp_path / "house"


def test_this_test_sees_circles_through_functions_and_relative_imports(house: Path) -> None:
    graph = import_graph(house)
    assert circles(graph) == [["house.cell.build", "house.cell.cell", "house.cell.entry"]]
    assert circles(rooms_of(graph)) == []
    (house / "cell" / "entry.py").write_text("def use():\n    import house.answer")
    graph = import_graph(house)
    around = ["house.cell", "house.cell.build", "house.cell.cell", "house.cell.entry"]
    assert circles(graph) == [["house.answer", *around]]
    assert circles(rooms_of(graph)) == [["answer", "cell"]]


def test_this_test_sees_a_climb_and_lets_type_checkers_look_up(house: Path) -> None:
    assert climbs(import_graph(house)) == ["house.path imports house.answer from a floor above"]
    (house / "path.py").write_text("def later():\n    from house import task")
    assert climbs(import_graph(house)) == ["house.path imports house.task from a floor above"]
    assert circles(import_graph(house))[-1] == ["house.path", "house.task"]


def loaded_by(statement: str) -> set[str]:
    """Return the modules that a fresh process holds after `statement`."""
    code = f"{statement}\nimport sys\nprint(*sorted(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=LONG
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

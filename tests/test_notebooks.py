"""The lessons: text and notebook agree, hold no outputs, and show the scene in a saved copy."""

import ast
import json
import pathlib
import re

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "notebooks"
LESSONS = ["01_paper", "02_your_own_cell", "03_indices", "04_global_against_local",
           "05_benchmarking", "06_placement"]  # fmt: skip


def notebook(name):
    return json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))


def source(cell):
    return "".join(cell["source"])


def code(name):
    return "\n".join(source(c) for c in notebook(name)["cells"] if c["cell_type"] == "code")


def test_every_lesson_is_there_as_text_and_as_notebook():
    assert sorted(f.stem for f in FOLDER.glob("*.py")) == LESSONS
    assert sorted(f.stem for f in FOLDER.glob("*.ipynb")) == LESSONS


@pytest.mark.parametrize("name", LESSONS)
def test_text_and_notebook_agree(name):
    jupytext = pytest.importorskip("jupytext")
    text = jupytext.read(FOLDER / f"{name}.py")
    both = [
        [(cell["cell_type"], source(cell)) for cell in cells]
        for cells in (text.cells, notebook(name)["cells"])
    ]
    assert both[0] == both[1], f"run: jupytext --sync notebooks/{name}.py"


@pytest.mark.parametrize("name", LESSONS)
def test_notebook_holds_no_outputs(name):
    assert not notebook(name)["metadata"].get("widgets")
    for cell in notebook(name)["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None
        assert not set(cell["metadata"]) - {"tags"}


@pytest.mark.parametrize("name", LESSONS)
def test_lesson_teaches_checks_and_shows(name):
    """It begins with its title, ends with exercises, asserts numbers, and has a scene inline."""
    cells = notebook(name)["cells"]
    texts = [source(cell) for cell in cells if cell["cell_type"] == "markdown"]
    assert re.match(rf"# {int(name[:2])}\. \S", texts[0])
    assert re.search(r"^## Exercises$", texts[-1], flags=re.M)
    tree = ast.parse(re.sub(r"^%.*$", "", code(name), flags=re.M))
    asserts = [node for node in ast.walk(tree) if isinstance(node, ast.Assert)]
    assert len(asserts) >= 5
    called = {
        node.func.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
    }
    assert "Player" in called


@pytest.mark.parametrize("name", LESSONS)
def test_lesson_names_no_place_of_this_machine(name):
    text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    assert not re.search(r"(?<![\w.])/(home|tmp|root|work|Users)/", text)

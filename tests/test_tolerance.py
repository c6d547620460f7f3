"""Tolerances stand in one record, and every number that was chosen says why."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "dualarm_pin"


def tolerances_in(text: str) -> Iterator[str]:
    """Return the lines that compare with a small number of their own.

    Below 1e-11 it is slack for rounding, above 1e-3 hardly a tolerance.
    """
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Compare):
            inner = (c.value for c in ast.walk(node) if isinstance(c, ast.Constant))
            if any(isinstance(value, float) and 1e-11 < value <= 1e-3 for value in inner):
                yield str(node.lineno)


def numbers_without_reason(text: str) -> Iterator[str]:
    """Return the numbers of a module that have no comment in their block, and no docstring.

    Names for 0, 1, 2, ... need none.
    """
    lines, body = ["", *text.splitlines()], ast.parse(text).body
    for node, after in itertools.zip_longest(body, body[1:]):
        explained = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        if not isinstance(node, ast.Assign) or explained:
            continue
        values = _numbers(node.value)
        if not values or (len(values) > 1 and values == list(range(len(values)))):
            continue
        first = node.lineno
        while lines[first - 1] and not lines[first].startswith("#"):
            first -= 1
        if not any("#" in line for line in lines[first : node.lineno + 1]):
            yield ast.unparse(node.targets[0]).strip("()").replace(" ", "")


def _numbers(node: ast.expr) -> list[object]:
    parts = node.elts if isinstance(node, ast.Tuple) else [node]
    values = [part.value for part in parts if isinstance(part, ast.Constant)]
    right = len(values) == len(parts) and all(type(v) in (int, float) for v in values)
    return values if right else []


def found(check: Callable[[str], Iterator[str]]) -> Iterator[tuple[str, str]]:
    """Return the file and what `check` finds in it, over the package."""
    for file in sorted(PACKAGE.rglob("*.py")):
        for what in check(file.read_text(encoding="utf-8")):
            yield file.name, what


def test_comparisons_take_their_tolerance_from_the_record() -> None:
    places = [f"{file}:{line}" for file, line in found(tolerances_in)]
    assert places == []


def test_every_constant_says_why() -> None:
    assert list(found(numbers_without_reason)) == []


@pytest.mark.parametrize("line", ["x < 1e-6", "a <= b * (1.0 + 1e-5)", "max(x, 1e-9) > y"])
def test_a_tolerance_in_a_comparison_is_seen(line: str) -> None:
    assert list(tolerances_in(f"def f(x):\n    return {line}")) == ["2"]
    assert list(tolerances_in("x < TOLERANCE.position")) == []


def test_a_constant_without_a_comment_is_seen() -> None:
    text = "A = 3\n\n# metres\nB = 4.0\nX = 5.0\n\nC, D = 1, 2\nE = 5  # of them\nF = f(3)\n"
    assert list(numbers_without_reason(text + "G = ()\nH, I = 0, 1\n")) == ["A", "C,D"]

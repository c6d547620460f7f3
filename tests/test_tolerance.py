"""Tolerances stand in one record, and every number that was chosen says why."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "dualarm_pin"
# Files whose owners have yet to follow; both lists end empty, and what is mended leaves them.
TOLERANCES_ELSEWHERE: list[str] = [
    "cell/read_urdf.py",
    "cell/settle.py",
    "engine/interior_point.py",
    "files/cell_spec.py",
    "inspection.py",
    "path/files/apt.py",
    "path/files/gcode.py",
    "path/generators/curve.py",
    "path/generators/follow.py",
    "planners/peers.py",
]
NO_REASON: list[str] = [
    "arrays.py: _NO_LENGTH",
    "cell/inspect.py: _POSTURES",
    "cell/inspect.py: _REACH_SAMPLES",
    "cli/__init__.py: (DONE, NOT_FOUND, BAD_INPUT, INTERRUPTED)",
    "cli/bench.py: GATE_FAILED",
    "engine/barrier.py: _LOG_SAFE",
    "engine/interior_point.py: (_MU_FACTOR, _MU_POWER, _MU_ERROR)",
    "engine/interior_point.py: _TAU_MIN",
    "engine/line_search.py: (_GAMMA_VIOLATION, _GAMMA_OBJECTIVE, _ARMIJO)",
    "engine/line_search.py: (_SWITCH_SLOPE, _SWITCH_VIOLATION)",
    "engine/newton.py: (_SHIFT_FIRST, _SHIFT_MIN, _SHIFT_MAX)",
    "engine/newton.py: (_SHIFT_GROW_FIRST, _SHIFT_GROW, _SHIFT_SHRINK)",
    "engine/solve.py: _CHUNKS_PER_JOB",
    "engine/workspace.py: FILTER_SIZE",
    "evidence/verdict.py: CLOSED_GAP",
    "files/source.py: _MOST_VALUES",
    "files/suite_spec.py: _MOST_STEPS",
    "inspection.py: _TRIES",
    "paper.py: RANDOM_STARTS",
    "path/files/machine_program.py: INCH",
    "path/files/machine_program.py: MILLIMETRE",
    "path/generators/stand.py: _LARGEST",
    "path/generators/stand.py: _MOST",
    "path/path.py: (WHOLE_POSE, SPIN_FREE, POSITION_ONLY)",
    "show/binary.py: _ALIGN",
    "show/notebook.py: _LEAST_HEIGHT",
    "task.py: LEAST_POINTS",
]


def tolerances_in(text: str) -> Iterator[int]:
    """Return the lines that compare with a small number of their own.

    Below 1e-11 it is slack for rounding, above 1e-3 hardly a tolerance.
    """
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Compare):
            inner = (c.value for c in ast.walk(node) if isinstance(c, ast.Constant))
            if any(isinstance(value, float) and 1e-11 < value <= 1e-3 for value in inner):
                yield node.lineno


def numbers_without_reason(text: str) -> Iterator[str]:
    """Return the constants of a module that are numbers and whose block has no comment.

    Names for 0, 1, 2, ... need none.
    """
    lines = ["", *text.splitlines()]
    for node in ast.parse(text).body:
        if not isinstance(node, ast.Assign):
            continue
        values = _numbers(node.value)
        if not values or (len(values) > 1 and values == list(range(len(values)))):
            continue
        first = node.lineno
        while lines[first - 1] and not lines[first].startswith("#"):
            first -= 1
        if not any("#" in line for line in lines[first : node.lineno + 1]):
            yield ast.unparse(node.targets[0])


def _numbers(node: ast.expr) -> list[object]:
    parts = node.elts if isinstance(node, ast.Tuple) else [node]
    values = [part.value for part in parts if isinstance(part, ast.Constant)]
    right = len(values) == len(parts) and all(type(v) in (int, float) for v in values)
    return values if right else []


def found(check, unless: str) -> list[str]:  # type: ignore[no-untyped-def]
    files = sorted(PACKAGE.rglob("*.py"))
    return [
        f"{file.relative_to(PACKAGE)}: {where}"
        for file in files
        if file.name != unless
        for where in check(file.read_text(encoding="utf-8"))
    ]


def test_comparisons_take_their_tolerance_from_the_record() -> None:
    files = {where.split(":")[0] for where in found(tolerances_in, "tolerance.py")}
    assert sorted(files) == TOLERANCES_ELSEWHERE


def test_every_constant_says_why() -> None:
    assert found(numbers_without_reason, "") == NO_REASON


@pytest.mark.parametrize("line", ["x < 1e-6", "a <= b * (1.0 + 1e-5)", "max(x, 1e-9) > y"])
def test_a_tolerance_in_a_comparison_is_seen(line: str) -> None:
    assert list(tolerances_in(f"def f(x):\n    return {line}")) == [2]
    assert list(tolerances_in("x < TOLERANCE.position")) == []


def test_a_constant_without_a_comment_is_seen() -> None:
    text = "A = 3\n\n# metres\nB = 4.0\nX = 5.0\n\nC, D = 1, 2\nE = 5  # of them\nF = f(3)\n"
    assert list(numbers_without_reason(text + "G = ()\nH, I = 0, 1\n")) == ["A", "(C, D)"]

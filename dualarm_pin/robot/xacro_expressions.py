"""Which expressions of a xacro file are evaluated: arithmetic and a list of harmless functions.

xacro evaluates `${...}` and `$(eval ...)` as Python, with guards that are no wall. So every one is
read first, and what is not on the list is refused: a robot from a stranger runs no code.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dualarm_pin.errors import InputError

FUNCTIONS = frozenset(name for name in vars(math) if not name.startswith("_")) | {
    "abs", "arg", "bool", "dict", "dirname", "dotify", "find", "float", "get", "int", "len",
    "list", "load_yaml", "max", "min", "replace", "round", "split", "str", "sum", "tuple",
}  # fmt: skip
_TOO_COSTLY = {"factorial", "comb", "perm", "pow"}  # of math: a short text asks for years of work
_NODES = (
    ast.Expression, ast.Constant, ast.Name, ast.Load, ast.Attribute, ast.Subscript, ast.Slice,
    ast.Call, ast.keyword, ast.UnaryOp, ast.unaryop, ast.BinOp, ast.operator, ast.BoolOp,
    ast.boolop, ast.Compare, ast.cmpop, ast.IfExp, ast.List, ast.Tuple, ast.Dict,
)  # fmt: skip
_LONGEST = 2000  # characters of an expression
_HIGHEST = 64  # of a power: beyond, integers fill the memory
_LARGEST = 20_000_000  # bytes of a file that is included


def refuse_code(expression: str) -> None:
    """Refuse what is more than arithmetic and calls of `FUNCTIONS`.

    Raises:
        InputError: It is; the message says what of it.
    """
    if len(expression) > _LONGEST:
        raise InputError(f"an expression of {len(expression)} characters: {_LONGEST} are allowed")
    try:
        nodes = list(ast.walk(ast.parse(expression.strip(), mode="eval")))
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{expression!r} is no expression: {error}") from error
    for node in nodes:
        what = _not_harmless(node)
        if what is not None:
            raise InputError(
                f"the expression {expression!r} is code ({what}), which is not run: arithmetic and "
                "functions such as sin, min and load_yaml are; expand the file yourself with "
                "`xacro in.xacro -o out.urdf` if you trust it"
            )


def _not_harmless(node: ast.AST) -> str | None:
    if not isinstance(node, _NODES):
        return type(node).__name__.lower()
    if isinstance(node, ast.Name | ast.Attribute):
        name = node.id if isinstance(node, ast.Name) else node.attr
        return name if name.startswith("_") else None
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.LShift):
        return "<<"
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        power = node.right.value if isinstance(node.right, ast.Constant) else None
        small = isinstance(power, int | float) and abs(power) <= _HIGHEST
        return None if small else f"a power above {_HIGHEST}"
    if isinstance(node, ast.Call):
        called = node.func
        name = getattr(called, "id", None) or getattr(called, "attr", None) or "a value"
        return None if name in FUNCTIONS - _TOO_COSTLY else f"a call of {name}"
    return None


@contextmanager
def harmless(xacro: Any, substitution: Any) -> Iterator[None]:
    """Let xacro evaluate harmless expressions alone, and read files alone.

    Args:
        xacro: The module.
        substitution: Its `substitution_args`.
    """
    safe_eval, absolute, whole = xacro.safe_eval, xacro.abs_filename_spec, substitution._eval
    read_environment = substitution._eval_env

    def guarded_eval(expression: str, *scope: Any) -> Any:
        refuse_code(expression)
        return safe_eval(expression, *scope)

    def guarded_whole(expression: str, context: Any) -> Any:
        refuse_code(expression)
        return whole(expression, context)

    def guarded_name(name: Any) -> Any:
        file = Path(absolute(str(name)))
        if file.exists() and not (file.is_file() and file.stat().st_size <= _LARGEST):
            raise InputError(f"{file} is no file of at most {_LARGEST} bytes")
        return str(file)

    def no_environment(name: str) -> Any:
        raise InputError(
            f"$(env {name}) is not read: the same file must give the same robot on every machine; "
            "make it a <xacro:arg>"
        )

    xacro.safe_eval, xacro.abs_filename_spec = guarded_eval, guarded_name
    substitution._eval, substitution._eval_env = guarded_whole, no_environment
    try:
        yield
    finally:
        xacro.safe_eval, xacro.abs_filename_spec = safe_eval, absolute
        substitution._eval, substitution._eval_env = whole, read_environment

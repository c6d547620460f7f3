"""The paper's equations are cited where they are implemented, all in one spelling: (eq. 8)."""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "dualarm_pin"
# Which rooms or modules implement what; (1) to (5) are the background of (6) and (7), and (21) is
# (10) again.
IMPLEMENTED = {
    6: ("indices",),  # force transmission ratio
    7: ("indices",),  # velocity transmission ratio
    8: ("indices",),  # weighted, force
    9: ("indices",),  # weighted, velocity
    10: ("relative",),  # relative pose
    11: ("relative",),  # relative Jacobian
    12: ("planners",),  # pseudo-inverse
    13: ("planners",),  # gradient in null space
    14: ("indices",),  # the index
    15: ("problem",),  # its sum over the points
    16: ("problem",),  # joint bounds
    17: ("rows",),  # poses of the path
    18: ("problem",),  # fourth powers of the steps
    19: ("problem", "planners"),  # both together
    20: ("problem", "planners"),  # fixed neighbours
}
NUMBER = r"(?:[1-9]|1\d|2[01])"
CITED = re.compile(rf"\(eq\. ({NUMBER})\)")


def prose(text: str) -> Iterator[str]:
    """Return the docstrings and comments of a module."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or token.string.startswith('"""'):
            yield token.string


def rooms() -> dict[str, str]:
    """Return all docstrings and comments by room."""
    texts: dict[str, str] = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        room = file.relative_to(PACKAGE).with_suffix("").parts[0]
        said = "\n".join(prose(file.read_text(encoding="utf-8")))
        texts[room] = f"{texts.get(room, '')}\n{said}"
    return texts


def misspelt(text: str) -> list[str]:
    """Return what looks like the citation of an equation but is not spelt (eq. 8)."""
    rest = CITED.sub("", text)
    bare = rf"(?<![\w\])])\({NUMBER}\)|\b[Ee]qs?\. ?\(?{NUMBER}|\b[Ee]quations? \(?{NUMBER}\b"
    return re.findall(bare, rest)


@pytest.mark.parametrize("number", IMPLEMENTED)
def test_an_equation_is_cited_by_what_implements_it(number: int) -> None:
    texts = rooms()
    said = "".join(texts.get(room, "") for room in IMPLEMENTED[number])
    assert str(number) in CITED.findall(said)


def test_citations_have_one_spelling() -> None:
    found = {room: misspelt(text) for room, text in rooms().items()}
    assert {room: words for room, words in found.items() if words} == {}


@pytest.mark.parametrize("text", ["see (19)", "eq. (11)", "(eq. 8, 9)", "Eq. 3", "equation (4)"])
def test_another_spelling_is_seen(text: str) -> None:
    assert misspelt(text)


@pytest.mark.parametrize("text", ["see (eq. 19)", "q (6, n)", "f(3)", "(eq. 6), (eq. 8)"])
def test_the_right_spelling_is_not(text: str) -> None:
    assert not misspelt(text)

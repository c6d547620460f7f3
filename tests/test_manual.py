"""The manual: its pages say what happens, and a copy from disk needs nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from scripts import script_of

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGES = sorted((DOCS / "manual" / "howto").glob("*.md"))


@pytest.fixture(scope="module")
def run_page():
    return script_of(DOCS / "run_page.py")


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_commands_of_a_page_print_what_it_shows(page: Path) -> None:
    command = [sys.executable, str(DOCS / "run_page.py"), str(page)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


PAGE = """
```{code-block} text
:caption: words.txt

one 1.000
two
```

```sh
cat words.txt
```

```text
one 1.001
two
```
"""


def test_a_page_that_says_something_else_is_found(run_page, tmp_path: Path) -> None:
    def wrong(text: str) -> list[str]:
        return list(run_page.complaints(text, run_page.run(text, tmp_path)))

    assert wrong(PAGE) == []
    assert wrong(PAGE.replace("```text\none 1.001\n", "```text\n...\n")) == []
    for page, other in (("one 1.001", "one 1.2"), ("\none 1.001", "\n"), ("1.001\ntwo", "1.001")):
        assert wrong(PAGE.replace(page, other)) != []
    assert wrong(PAGE.partition("```text\none 1.001")[0]) != []
    with pytest.raises(SystemExit, match="ended with 1"):
        run_page.run(PAGE.replace("cat words", "cat no"), tmp_path)


def test_the_last_digit_of_a_number_may_be_rounded_and_no_more(run_page) -> None:
    assert run_page.same("clearance 0.000 m", "clearance 0.001 m")
    assert not run_page.same("clearance 0.000 m", "clearance 0.002 m")
    assert not run_page.same("iterations 12", "iterations 13")


def test_the_first_page_takes_ten_commands_at_most(run_page) -> None:
    text = (DOCS / "manual" / "start.md").read_text(encoding="utf-8")
    commands = [command for command, _ in run_page.shown(text)]
    assert len(commands) <= 10
    assert commands[0].startswith("pip install")
    assert any("solve" in command for command in commands)

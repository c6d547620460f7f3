"""Run the commands of a page of the manual and hold it to what they print.

    python docs/run_page.py docs/manual/start.md [--write]

A block with a caption is a file, a block `sh` is run in its folder, and a block `text` below it is
what it prints. Numbers may differ by a hundredth; times, rounds of a search and what is said about
compiling may differ freely. `--write` puts what was printed into the page instead. Ends with 1
where a command fails or prints something else.
"""

from __future__ import annotations

import argparse
import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

BLOCK = re.compile(
    r"^```(?:\{code-block\} )?(?P<kind>\w+)\n(?::caption: (?P<file>\S+)\n\n)?(?P<body>.*?)^```\n",
    re.M | re.S,
)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
CLOSE, NOTHING = 1e-2, 1e-6  # share of a number, and what counts as zero (m, rad, m^2)
FREE = ("time ", "compil", "evidence ")  # lines that a machine decides: rounds differ by rounding
LEFT_OUT = "..."  # a line of a page: any number of lines


def main() -> None:
    """Run one page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--beside", type=Path, nargs="*", default=[], help="files to begin with")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for file in given.beside:
            shutil.copy(file, folder)
        text = given.page.read_text(encoding="utf-8")
        ran = run(text, Path(folder))
    if given.write:
        given.page.write_text(written(text, ran), encoding="utf-8")
    elif wrong := list(complaints(text, ran)):
        sys.exit("\n".join([f"{given.page} does not say what happens:", *wrong]))
    print(f"{given.page}: {len(ran)} commands ran")


def run(text: str, folder: Path) -> list[str]:
    """Make the files and run the commands of a page in order; return what each printed.

    Raises:
        SystemExit: One of them failed.
    """
    printed = []
    for block in BLOCK.finditer(text):
        if block["file"]:
            file = folder / block["file"]
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block["body"], encoding="utf-8")
        elif block["kind"] == "sh":
            done = subprocess.run(
                ["bash", "-euc", block["body"]],
                cwd=folder,
                env=os.environ | {"COLUMNS": "100", "PATH": _path()},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                check=False,
            )
            output = done.stdout.replace(f"{folder.resolve()}/", "").replace(f"{folder}/", "")
            if done.returncode != 0:
                raise SystemExit(f"{block['body']}ended with {done.returncode}:\n{output}")
            printed.append(output)
    return printed


def _path() -> str:
    """Return PATH with the folder of this Python first: its programs are the ones a page names."""
    return os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])


def shown(text: str) -> Iterator[tuple[str, re.Match[str] | None]]:
    """Yield each command with the block of what it prints, None without one."""
    blocks = [block for block in BLOCK.finditer(text) if not block["file"]]
    for block, after in itertools.zip_longest(blocks, blocks[1:]):
        if block["kind"] == "sh":
            answer = after is not None and after["kind"] == "text"
            yield block["body"], after if answer else None


def complaints(text: str, ran: list[str]) -> Iterator[str]:
    """Yield how the page and what was printed differ; a page that shows nothing says nothing."""
    for (command, block), output in zip(shown(text), ran, strict=True):
        page = [] if block is None else _lines(block["body"])
        said = _lines(output)
        if block is None and said:
            yield f"{command}  prints what the page does not show: {said[0]}"
        place = 0
        anywhere = False
        for line in page:
            if line == LEFT_OUT:
                anywhere = True
                continue
            found = (k for k in range(place, len(said)) if same(line, said[k]))
            at = next(found, None)
            if at is None or (at > place and not anywhere):
                there = said[place] if place < len(said) else "the end"
                yield f"{command}  page: {line}\n  here: {there}"
                break
            place, anywhere = at + 1, False
        else:
            if block is not None and place < len(said) and not anywhere:
                yield f"{command}  prints more than the page shows: {said[place]}"


def same(page: str, printed: str) -> bool:
    """Tell whether two lines have the same words and numbers close to each other."""
    if NUMBER.sub("#", page).split() != NUMBER.sub("#", printed).split():
        return False
    pairs = zip(NUMBER.findall(page), NUMBER.findall(printed), strict=True)
    return all(_close(float(a), float(b), _last_place(a)) for a, b in pairs)


def _close(a: float, b: float, unit: float) -> bool:
    return abs(a - b) <= max(CLOSE * abs(a), NOTHING, 1.01 * unit)


def _last_place(number: str) -> float:
    """Return what the last digit behind the point of a number is worth: it may be rounded."""
    _, point, behind = number.partition(".")
    return 10.0 ** -len(behind) if point and "e" not in behind else 0.0


def _lines(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.strip() and not line.startswith(FREE)]


def written(text: str, ran: list[str]) -> str:
    """Return the page with what was printed; lines left out stay left out."""
    for (_, block), output in reversed(list(zip(shown(text), ran, strict=True))):
        if block is not None:
            body = _cut(block["body"].splitlines(), output.rstrip().splitlines())
            text = text[: block.start("body")] + body + text[block.end("body") :]
    return text


def _cut(page: list[str], output: list[str]) -> str:
    """Keep the lines of the output around those that the page leaves out: `... N M`."""
    if LEFT_OUT in page and (k := page.index(LEFT_OUT)) + 1 < len(page):
        rest = len(page) - k - 1
        output = [*output[:k], LEFT_OUT, *output[len(output) - rest :]]
    return "\n".join(output) + "\n"


if __name__ == "__main__":
    main()

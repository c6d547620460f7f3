"""Pages of the manual that are made from the program when the manual is built.

An extension of Sphinx: the reference of files comes from their specifications, of commands from
their help, of Python from docstrings; the live pages of the gallery from the results beside this.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer

import dualarm_pin
from dualarm_pin.answer.folder import labels, load_result
from dualarm_pin.cli import app as commands
from dualarm_pin.explain import FILES, Key, every_key, shown
from dualarm_pin.files.documented import first_line
from dualarm_pin.motion.record import motions_of
from dualarm_pin.show import report_page

RESULTS = Path(__file__).resolve().parent / "results"


def setup(sphinx: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    sphinx.connect("builder-inited", write_reference)
    sphinx.connect("build-finished", write_gallery)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_reference(sphinx: Sphinx) -> None:
    """Write the pages of the reference beside the others, before they are read."""
    pages = {f"{name}.md": file_page(name) for name in FILES}
    pages |= {"commands.md": commands_page(), "python.rst": python_page()}
    folder = Path(sphinx.srcdir) / "reference"
    folder.mkdir(exist_ok=True)
    for name, content in pages.items():
        file = folder / name
        if not file.is_file() or file.read_text(encoding="utf-8") != content:
            file.write_text(content, encoding="utf-8")


def write_gallery(sphinx: Sphinx, failure: Exception | None) -> None:
    """Write the live pages."""
    if failure is None:
        folder = Path(sphinx.outdir) / "gallery"
        folder.mkdir(exist_ok=True)
        for results in sorted(RESULTS.iterdir()):
            (folder / f"{results.name}.html").write_bytes(live_page(results.name))


def live_page(gallery: str) -> bytes:
    """Return the page of one or several results: it holds all that it needs."""
    folders = sorted(each for each in (RESULTS / gallery).iterdir() if each.is_dir())
    folders = folders or [RESULTS / gallery]
    loaded = dict(zip(labels(folders), map(load_result, folders), strict=True))
    motions = motions_of(dict(zip(loaded, folders, strict=True)))
    return report_page(loaded, title=gallery, motions=motions)


def file_page(name: str) -> str:
    """Return the reference of a kind of file: a table for each of its sections."""
    lines = [f"# {name.capitalize()} file", "", first_line(FILES[name]), ""]
    lines += [f"The same on the terminal: `dualarm-pin explain {name}`.", ""]
    keys = [key for key in every_key() if key.place.startswith(f"{name}.")]
    plain = [key for key in keys if key.place.count(".") == 1 and not key.sections]
    lines += ["## Keys without a section", "", *_table(plain, name), ""] if plain else []
    for key in keys:
        if key.place.count(".") == 1 and key.sections:
            below = [each for each in keys if each.place.startswith(f"{key.place}.")]
            section = key.place.partition(".")[2]
            lines += [f"## {section}", "", *_table([key], name), "", *_table(below, key.place), ""]
    return "\n".join(lines)


def _table(keys: list[Key], under: str) -> Iterator[str]:
    yield "| key | meaning | unit | default | example |"
    yield "|---|---|---|---|---|"
    for key in keys:
        place = key.place.removeprefix(f"{under}.")
        default = "*needed*" if key.required else _code(shown(key.default))
        unit, example = key.said.unit or "", _code(shown(key.said.example))
        yield f"| `{place}` | {_cell(key.said.text)} | {unit} | {default} | {example} |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


def _code(text: str | None) -> str:
    return "" if text is None else f"`{_cell(text)}`"


def commands_page() -> str:
    """Return the reference of the commands, from their help."""
    text: str = commands.generate_docs(output_format="markdown", include_hidden=False)
    _, _, body = text.partition("\n## ")
    start = body.index("\n## dualarm-pin ")
    codes = "0 done and verified; 1 no solution found; 2 wrong input; 130 and 143 stopped."
    head = f"# Commands\n\n{commands.help}\n\nExit codes: {codes}\n"
    return head + body[start:].replace("\n    ", " ")


def python_page() -> str:
    """Return the reference of the names of `import dualarm_pin as dp`, from their docstrings."""
    homes, modules = dualarm_pin._HOMES, dualarm_pin._MODULES
    lines = ["Python", "======", "", "What ``import dualarm_pin as dp`` gives: nouns, verbs, and"]
    lines += ["modules to choose from.", ""]
    nouns = sorted(name for name in homes if name[0].isupper())
    verbs = sorted(name for name in homes if name[0].islower())
    for title, names in (("Nouns", nouns), ("Verbs", verbs)):
        lines += [title, "-" * len(title), ""]
        for name in names:
            lines += _documented(f"dualarm_pin.{homes[name]}", name)
    for name, home in sorted(modules.items()):
        lines += [f"dp.{name}", "-" * (len(name) + 3), ""]
        lines += [f".. automodule:: dualarm_pin.{home}", "   :no-index:", ""]
        for member in sorted(getattr(dualarm_pin, name).__all__):
            if member not in homes:
                lines += _documented(f"dualarm_pin.{home}", member)
    return "\n".join(lines) + "\n"


def _documented(home: str, name: str) -> list[str]:
    thing = getattr(importlib.import_module(home), name)
    if isinstance(thing, type):
        return [f".. autoclass:: {home}.{name}", "   :members:", ""]
    if callable(thing):
        return [f".. autofunction:: {home}.{name}", ""]
    if ("", name) not in ModuleAnalyzer.for_module(home).find_attr_docs():
        return []  # a table by name, documented where it is made
    return [f".. autodata:: {home}.{name}", "   :no-value:", ""]

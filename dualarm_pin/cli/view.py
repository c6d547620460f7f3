"""`dualarm-pin view`."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE
from dualarm_pin.errors import InputError


def view(
    results: Annotated[tuple[Path, ...], Parameter(negative=())],
    /,
    *,
    html: Path | None = None,
    port: int = 0,
    browser: bool = True,
) -> int:
    """Show results in the browser, or write them as one file that opens without a network.

    Args:
        results: Folders that `solve --out` wrote; several are compared.
        html: Write this file instead of opening a browser.
        port: Port of the local page; a free one by default.
        browser: Open the page in the browser.
    """
    from dualarm_pin.answer.folder import load_result
    from dualarm_pin.show import report_page, result_of, serve, write_report

    if not results:
        raise InputError("name at least one result folder", field="RESULT_DIR")
    loaded = [
        result_of(label, *load_result(folder))
        for label, folder in zip(_labels(results), results, strict=True)
    ]
    title = loaded[0].path.name if len(loaded) == 1 else f"{len(loaded)} results"
    title = f"{loaded[0].cell.name}: {title}"
    if html is not None:
        write_report(html, loaded, title=title)
        print(f"written to {html}")
        return DONE
    serve(
        report_page(loaded, title=title),
        port,
        browser,
        ready=lambda address: print(f"{address} (Ctrl-C ends it)", flush=True),
    )
    return DONE


def _labels(folders: tuple[Path, ...]) -> list[str]:
    """Return the names of the folders, with their parents where names repeat."""
    count = Counter(folder.resolve().name for folder in folders)
    full = [folder.resolve() for folder in folders]
    return [f.name if count[f.name] == 1 else f"{f.parent.name}/{f.name}" for f in full]

"""`dualarm-pin view`."""

from __future__ import annotations

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
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Show results in the browser, or write them as one file that opens without a network.

    Args:
        results: Folders that `solve --out` wrote; several are compared, and their
            alternatives beside them.
        html: Write this file instead of opening a browser.
        port: Port of the local page; a free one by default.
        browser: Open the page in the browser.
        allow_code: Import and run the index, path or rows that a task names with `call`.
    """
    from dualarm_pin.answer.folder import labels, load_result, with_alternatives
    from dualarm_pin.motion.record import motions_of
    from dualarm_pin.show import report_page, serve, write_report
    from dualarm_pin.show.sensitivity import load_costs

    if not results:
        raise InputError("name at least one result folder", field="RESULT_DIR")
    folders = {
        label if at == 0 else f"{label}, {folder.name}": folder
        for label, result in zip(labels(results), results, strict=True)
        for at, folder in enumerate(with_alternatives(result))
    }
    loaded = {label: load_result(each, allow_code=allow_code) for label, each in folders.items()}
    motions = motions_of(folders)
    known = {label: load_costs(folder) for label, folder in folders.items()}
    costs = {label: each for label, each in known.items() if each is not None}
    first, _ = next(iter(loaded.values()))
    title = first.path.name if len(loaded) == 1 else f"{len(loaded)} results"
    title = f"{first.cell.name}: {title}"
    if html is not None:
        write_report(html, loaded, title=title, motions=motions, costs=costs)
        print(f"written to {html}")
        return DONE
    serve(
        report_page(loaded, title=title, motions=motions, costs=costs),
        port,
        browser,
        ready=lambda address: print(f"{address} (Ctrl-C ends it)", flush=True),
    )
    return DONE

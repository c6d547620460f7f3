"""`report.html`: what a batch came to, in one file that opens without a network."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from dualarm_pin.bench.columns import Row
from dualarm_pin.bench.kept_trajectories import best_folder
from dualarm_pin.bench.report import statistics as stats
from dualarm_pin.bench.report.charts import legend, map_chart, profile_chart
from dualarm_pin.bench.report.html_tables import gates_table, overview_table, problem_table
from dualarm_pin.bench.report.provenance import provenance
from dualarm_pin.bench.report.statistics import Problem, Summary
from dualarm_pin.errors import DualArmError
from dualarm_pin.files.suite_spec import MapEntry
from dualarm_pin.files.write import write_bytes
from dualarm_pin.show.page import render_page, render_text_page
from dualarm_pin.show.scene import Scene

if TYPE_CHECKING:
    from dualarm_pin.bench.batch import BatchResult
    from dualarm_pin.bench.suite import Suite

MOST_SCENES = 16  # tasks in the 3D view; meshes are stored once a cell
_CODE = re.compile("`([^`]*)`")
_MOST_TABLES = 30  # variants whose tables stand open; the rest is in the table files
_LIMITATIONS = (
    "An objective is comparable within a task and variant alone; sums over tasks use ratios.",
    "A method that leaves the bounds or the path is not found, whatever its index; its mean is "
    "shown only together with its bound violation and pose error.",
    "`best known` means best of the starts made; it is not a proof. A gap to a lower bound holds "
    "as far as the search of its pieces went.",
    "Times are wall times of the methods themselves on the machines below, each with one thread; "
    "loading, compiling and the checks of the harness are not in them.",
    "Distances are those at the points of the path, and between them where a clearance is asked.",
)


def write_report(suite: Suite, batch: BatchResult, command: str) -> None:
    """Write `report.html` into the folder of a batch.

    Args:
        suite: The suite.
        batch: What came of it.
        command: The exact command to repeat it.

    Raises:
        InputError: The folder cannot be written.
    """
    allow_code = any(run.allow_code for run in suite.runs)
    scene, shown, left_out = _scene(batch, allow_code)
    groups = stats.summaries(batch.rows)
    methods = list(dict.fromkeys(row["method"] for row in batch.rows))
    parts = [
        '<main class="bench">',
        f"<h1>{escape(suite.title)}</h1>",
        _headline(batch, groups, methods),
        gates_table(batch.gates),
        _maps(suite.spec.maps, batch.rows),
        "<h2>Methods over all tasks</h2>",
        overview_table(batch.rows, methods),
        _profiles(batch.rows),
        "<h2>Task by task</h2>",
        _problems(groups),
        _stage(shown, left_out),
        _limitations(suite),
        provenance(suite, batch, command),
        "</main>",
    ]
    title, content, styles = f"{suite.title}: benchmark", "\n".join(parts), ("bench.css",)
    page = (
        render_page(title, scene.pack(), content=content, styles=styles)
        if shown
        else render_text_page(title, content, styles=styles)
    )
    write_bytes(batch.folder / "report.html", page)


def _headline(
    batch: BatchResult, groups: dict[Problem, list[Summary]], methods: Sequence[str]
) -> str:
    tasks = {task for task, _ in groups}
    counts = ", ".join(
        f"{count} {escape(status.replace('_', ' '))}"
        for status, count in batch.counts.most_common()
    )
    variants = f" in {len(groups)} variants" if len(groups) > len(tasks) else ""
    return (
        f'<p class="quiet">{len(batch.rows)} runs: {_count(len(tasks), "task")}{variants}, '
        f"{_count(len(methods), 'method')}. {counts}. Methods stand in the order of the suite; "
        "nothing here ranks them by an index without the bound violation beside it.</p>"
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")


def _maps(maps: Sequence[MapEntry], rows: Sequence[Row]) -> str:
    parts = []
    for chart in maps:
        best: dict[tuple[float, float], Row | None] = {}
        for row in rows:
            place = (float(row["set"][chart.x]), float(row["set"][chart.y]))
            known = best.setdefault(place, None)
            value = row.get(chart.of) if row["found"] else None
            if value is not None and (known is None or value < known[chart.of]):
                best[place] = row
        values = {place: None if row is None else row[chart.of] for place, row in best.items()}
        collides = [place for place, row in best.items() if row is not None and _touches(row)]
        labels = chart.label_x or chart.x, chart.label_y or chart.y
        parts.append(
            f"<figure>{map_chart(values, *labels, chart.of, collides)}"
            f"<figcaption>Best {escape(chart.of)} of the runs that were found, within all bounds. "
            "Crossed: links touch there; hatched: nothing was found; framed: the least that is "
            "free.</figcaption></figure>"
        )
    return f"<h2>Maps</h2>{''.join(parts)}" if parts else ""


def _profiles(rows: Sequence[Row]) -> str:
    charts = (
        (
            "Objective: share of runs within a ratio of the best of their task",
            "1 + (objective - best) / best",
            stats.excesses(rows),
        ),
        (
            "Time: share of runs within a ratio of the fastest method on the same task and seed",
            "wall time / fastest",
            stats.time_ratios(rows),
        ),
    )
    figures = [
        f"<figure>{profile_chart({m: stats.profile(v) for m, v in ratios.items()}, label)}"
        f"<figcaption>{caption}</figcaption></figure>"
        for caption, label, ratios in charts
    ]
    names = list(charts[0][2])
    return (
        f'<h2>Performance profiles</h2>{legend(names)}<div class="pair">{"".join(figures)}</div>'
        '<p class="quiet">A run that found nothing within the bounds never comes within a ratio: '
        "a curve that ends below 100 % says how often.</p>"
    )


def _problems(groups: dict[Problem, list[Summary]]) -> str:
    parts = []
    for number, ((task, variant), group) in enumerate(groups.items()):
        if number == _MOST_TABLES:
            parts.append(
                f'<p class="quiet">{len(groups) - number} more variants are in results.csv and '
                "results.parquet.</p>"
            )
            break
        heading = escape(task) + (f" <small>{escape(variant)}</small>" if variant else "")
        table = f"<h3>{heading}</h3>{problem_table(group)}"
        if len(groups) > 14:
            table = f"<details><summary>{heading}</summary>{problem_table(group)}</details>"
        parts.append(table)
    return "".join(parts)


def _scene(batch: BatchResult, allow_code: bool) -> tuple[Scene, list[str], int]:
    """Return the best trajectory of each task as one scene, their labels, and how many are out."""
    from dualarm_pin.answer.folder import load_result

    best: dict[str, Row] = {}
    for row in batch.rows:
        if row["found"] and row["objective"] is not None:
            known = best.get(row["task"])
            if known is None or _order(row, known) < _order(known, row):
                best[row["task"]] = row
    scene, labels = Scene(), []
    for task, row in list(best.items())[:MOST_SCENES]:
        label = f"{task}: {row['method']}" + (f", {row['variant']}" if row["variant"] else "")
        try:
            folder = best_folder(batch.folder, (task, row["variant"]))
            scene.add(label, *load_result(folder, allow_code=allow_code))
        except DualArmError:  # not kept, or its robots are gone: the tables stand without it
            continue
        labels.append(label)
    return scene, labels, len(best) - len(labels)


def _order(row: Row, other: Row) -> tuple[bool, float, float]:
    """Objectives decide within a variant; between variants what is free, then the mean index."""
    if row["variant"] == other["variant"]:
        return False, row["objective"], row["seed"]
    return _touches(row), row["mean_index"], row["seed"]


def _touches(row: Row) -> bool:
    """Tell whether links are known to touch; contact at exactly 0 counts."""
    clearance = row["min_clearance"]
    return clearance is not None and clearance <= 0.0


def _stage(labels: Sequence[str], left_out: int) -> str:
    if not labels:
        return "<h2>Motions</h2><p class='none'>No trajectory to show: none was found or kept.</p>"
    more = f" {left_out} more were not kept or do not fit on the page." if left_out else ""
    return (
        "<h2>Motions</h2>"
        '<p class="quiet">The best trajectory of each task: lowest objective of those found; over '
        f"variants the lowest mean index that is free of collision. Choose under “Runs”.{more}</p>"
        '<section id="player" class="player whole" aria-label="Animation"></section>'
        "<noscript>The robots are drawn with JavaScript: please switch it on.</noscript>"
    )


def _limitations(suite: Suite) -> str:
    texts = (escape(text) for text in (*suite.spec.limitations, *_LIMITATIONS))
    items = "".join("<li>" + _CODE.sub(r"<code>\1</code>", text) + "</li>" for text in texts)
    return f"<h2>Limitations</h2><ul>{items}</ul>"

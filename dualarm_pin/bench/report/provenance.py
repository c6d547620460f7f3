"""The end of the report: how to repeat it, what it ran on, what went in."""

from __future__ import annotations

from collections import Counter
from html import escape
from typing import TYPE_CHECKING

from dualarm_pin import __version__
from dualarm_pin.bench.fingerprints import file_digest

if TYPE_CHECKING:
    from dualarm_pin.bench.batch import BatchResult
    from dualarm_pin.bench.suite import Suite


def provenance(suite: Suite, batch: BatchResult, command: str) -> str:
    """Return the sections `Repeat it` and `Runs without an answer`."""
    return _unanswered(batch) + _repeat(suite, batch, command)


def _unanswered(batch: BatchResult) -> str:
    reasons = Counter(
        (row["method"], row["task"], row["status"], row["reason"])
        for row in batch.rows
        if row["status"] != "ok"
    )
    if not reasons:
        return ""
    lines = [
        f"<li>{count} &times; {escape(status.replace('_', ' '))}: {escape(method)} on "
        f"{escape(task)}: {escape(reason or '')}</li>"
        for (method, task, status, reason), count in reasons.most_common(60)
    ]
    return (
        f"<details><summary>Runs without an answer: {reasons.total()}</summary>"
        f"<ul>{''.join(lines)}</ul></details>"
    )


def _repeat(suite: Suite, batch: BatchResult, command: str) -> str:
    machines = Counter(
        tuple(str(row.get(f"machine.{part}") or "") for part in ("processor", "cores", "system"))
        for row in batch.rows
    )
    listed = "".join(
        f"<li>{count} runs on {escape(processor or 'an unknown processor')}, "
        f"{escape(cores)} cores, {escape(system)}</li>"
        for (processor, cores, system), count in machines.most_common()
    )
    inputs: dict[str, str] = {}
    for run in suite.runs:
        inputs |= {f"{run.task}: {name}": sha for name, sha in run.inputs.robots.items()}
    hashes = "\n".join(f"{sha}  {name}" for name, sha in sorted(inputs.items()))
    return (
        f"<h2>Repeat it</h2><pre>{escape(command)}</pre>"
        f"<p>dualarm-pin {escape(__version__)}; versions of all libraries, the machine and the "
        "hashes of all inputs of every run are in results.csv and results.parquet.</p>"
        f"<ul>{listed}</ul>"
        f"<details><summary>The suite ({escape(suite.file.name)}, sha256 "
        f"{file_digest(suite.file.resolve())[:16]}&hellip;)</summary>"
        f"<pre>{escape(suite.text)}</pre></details>"
        f"<details><summary>Robots and meshes</summary><pre>{escape(hashes)}</pre></details>"
    )

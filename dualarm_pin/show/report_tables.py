"""The tables of a report: result, evidence, provenance, all as text."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.show.report_result import Result

Rows = list[tuple[str, list[str]]]

_VERDICTS = {
    "local_only": "a local minimum; too little was searched to say more",
    "best_known": "best known of the starts below",
    "best_known_bounded": "best known, with a lower bound that holds as far as its search went",
}


def tables_of(results: Sequence[Result]) -> dict[str, Rows]:
    """Return rows of text by section; a row that no result fills is left out."""

    def rows(*lines: tuple[str, Callable[[Result], str]]) -> Rows:
        filled = [(name, [text(result) for result in results]) for name, text in lines]
        return [line for line in filled if any(line[1])]

    return {
        "Result": rows(
            ("found", lambda r: {True: "yes", False: "NO", None: ""}[r.summary.get("found")]),
            ("method", lambda r: str(r.summary.get("method", ""))),
            ("solver", lambda r: str(r.summary.get("solver", ""))),
            ("mean index", lambda r: _number(r.summary.get("mean_index"), r.units)),
            ("mean over arc length", lambda r: _number(r.summary.get("arc_mean_index"), r.units)),
            ("largest index", lambda r: _number(r.summary.get("max_index"), r.units)),
            ("objective", lambda r: _number(r.summary.get("objective"), digits=7)),
            ("smallest clearance", _clearance),
            ("arms apart by", lambda r: _least(r.between_arms)),
            ("largest joint step", lambda r: _number(r.summary.get("max_joint_step"), "rad or m")),
            ("bounds violated by", lambda r: _number(r.summary.get("max_bound_violation"), "")),
            ("position error", lambda r: _number(r.summary.get("max_position_error"), "m")),
            ("rotation error", lambda r: _number(r.summary.get("max_rotation_error"), "rad")),
            ("message", lambda r: str(r.summary.get("message") or "")),
        ),
        "Evidence": rows(
            ("verdict", lambda r: _VERDICTS.get(str(_evidence(r, "verdict")), "")),
            ("in words", _sentences),
            ("starts", _laws),
            (
                "a better optimum draws less than",
                lambda r: _share(_evidence(r, "missed_share_95"), " of the starts (95 %)"),
            ),
            ("lower bound", lambda r: _number(_evidence(r, "lower_bound"), digits=7)),
            ("gap to it", lambda r: _share(_evidence(r, "gap"))),
            ("stationarity", lambda r: _number(_evidence(r, "stationarity"))),
            ("smallest curvature", lambda r: _number(_evidence(r, "curvature_min"))),
            ("bounds that hold", lambda r: _number(_evidence(r, "active_bounds"))),
        ),
        "Provenance": rows(
            ("seed", lambda r: _number(r.summary.get("seed"), digits=20)),
            ("time", _time),
            ("versions", lambda r: _pairs(r.summary.get("versions"))),
            (
                "files read (SHA-256)",
                lambda r: "\n".join(f"{s.path.name} {s.sha256[:16]}…" for s in r.cell.sources),
            ),
        ),
    }


def _evidence(result: Result, key: str) -> Any:
    evidence = result.summary.get("evidence")
    return evidence.get(key) if isinstance(evidence, Mapping) else None


def _sentences(result: Result) -> str:
    extra = result.summary.get("extra")
    sentences = extra.get("evidence_text") if isinstance(extra, Mapping) else None
    return " ".join(str(sentences).split()) if sentences else ""


def _laws(result: Result) -> str:
    laws = _evidence(result, "laws")
    return "\n".join(
        f"{name}: {law['starts']} starts, {law['converged']} converged, "
        f"{law['minima']} minima, best hit {law['best_hits']}×"
        for name, law in (laws or {}).items()
    )


def _clearance(result: Result) -> str:
    if result.clearance is None:
        return "unknown"
    least = float(np.min(result.clearance))
    return "\n".join(
        text
        for text in (
            _number(least, "m") + (" IN COLLISION" if least < 0 else ""),
            result.nearest,
        )
        if text
    )


def _least(values: Array | None) -> str:
    return "" if values is None else _number(float(np.min(values)), "m")


def _time(result: Result) -> str:
    timing = result.summary.get("timing")
    if not isinstance(timing, Mapping):
        return ""
    names = {"wall_s": "wall", "cpu_s": "processor", "compile_s": "compiling"}
    return "\n".join(
        f"{text} {_number(timing[k], 's')}" for k, text in names.items() if k in timing
    )


def _pairs(values: object) -> str:
    return "\n".join(f"{k} {v}" for k, v in values.items()) if isinstance(values, Mapping) else ""


def _share(value: object, text: str = "") -> str:
    return f"{100 * float(value):.2g} %{text}" if isinstance(value, int | float) else ""


def _number(value: object, units: str = "", digits: int = 4) -> str:
    if not isinstance(value, int | float) or not math.isfinite(value):
        return ""
    text = f"{value:.{digits}g}" if isinstance(value, float) else str(value)
    return f"{text} {units}".strip()

"""The table of motions in a report, all as text."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dualarm_pin.motion.record import Motion
from dualarm_pin.motion.summary import MotionSummary
from dualarm_pin.motion.text import kinds_of, tightest

_SHOWN = 6  # limits in the table: those that hold the most of the path


def motion_rows(motions: Sequence[Motion | None]) -> list[tuple[str, list[str]]]:
    """Return rows of text, a column for each result; "" for one without a motion."""
    lines: list[tuple[str, Callable[[Motion, MotionSummary], str]]] = [
        ("law", lambda m, _: m.law.replace("_", " ")),
        ("duration", lambda _, s: f"{s.duration:.4g} s"),
        ("feed", lambda _, s: f"{s.feed:.5g} m/s"),
        ("largest feed", lambda _, s: f"{s.largest_feed:.5g} m/s" if s.largest_feed else ""),
        ("largest use", lambda _, s: "\n".join(_use(s, kind) for kind in kinds_of(s))),
        ("held back by", lambda _, s: _held(s)),
        ("samples from the path", lambda _, s: _pair(s.path_error_mm, s.path_error_deg)),
        ("chords from the path", lambda _, s: _pair(s.chord_error_mm, s.chord_error_deg)),
        ("torques", lambda _, s: _torques(s)),
        ("made of", lambda _, s: s.torque_note),
    ]
    rows = [
        (name, ["" if m is None else text(m, m.summary) for m in motions]) for name, text in lines
    ]
    return [(name, cells) for name, cells in rows if any(cells)]


def _use(summary: MotionSummary, kind: str) -> str:
    most = max((use for use in summary.limits if use.kind == kind), key=lambda use: use.largest)
    return f"{kind} {most.largest:.1%} {most.joint}"


def _held(summary: MotionSummary) -> str:
    shown = tightest(summary)[:_SHOWN]
    return "\n".join(f"{use.share:.0%} {use.joint or 'the tool'} {use.kind}" for use in shown)


def _pair(mm: float, deg: float) -> str:
    return f"{mm:.2g} mm, {deg:.2g} deg"


def _torques(summary: MotionSummary) -> str:
    lines = []
    for use in summary.torques:
        shares = ""
        if use.largest_share is not None and use.rms_share is not None:
            shares = f" ({use.largest_share:.0%}, RMS {use.rms_share:.0%} of the limit)"
        lines.append(f"{use.joint}: {use.largest:.4g} N m{shares}, {use.energy:.3g} J")
    return "\n".join(lines)

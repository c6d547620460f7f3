"""A motion as a few lines of text."""

from __future__ import annotations

from dualarm_pin.motion.record import Motion
from dualarm_pin.motion.summary import Kind, LimitUse, MotionSummary

_SHOWN = 4  # limits that hold the most of the path


def motion_text(motion: Motion) -> str:
    """Return a motion as a few lines of text."""
    s = motion.summary
    largest = "" if s.largest_feed is None else f", largest {s.largest_feed:.6g} m/s"
    lines = [
        f"motion       {motion.law.replace('_', ' ')}: {s.duration:.3f} s, feed {s.feed:.6g} m/s"
        f"{largest}; {len(motion.time)} samples",
        f"path         samples within {s.path_error_mm:.2g} mm and {s.path_error_deg:.2g} deg,"
        f" chords within {s.chord_error_mm:.2g} mm and {s.chord_error_deg:.2g} deg",
        "limits       " + ", ".join(_largest(s, kind) for kind in kinds_of(s)),
        "held by      " + ", ".join(_held(use) for use in tightest(s)[:_SHOWN]),
        f"clearance    {_metres(s.least_clearance)}, "
        f"between the arms {_metres(s.least_arm_clearance)}",
    ]
    if s.stretch > 1.0:
        lines[2] += f" (checked between grid points, then slowed by {s.stretch - 1.0:.1%})"
    if s.jerk:
        lines[2] += "; jerk is checked, not optimal"
    if s.torques:
        worst = max(s.torques, key=lambda use: use.largest_share or 0.0)
        energy = sum(use.energy for use in s.torques)
        share = "" if worst.largest_share is None else f" ({worst.largest_share:.0%})"
        if (worst.largest_share or 0.0) > 1.0 and "torque" not in kinds_of(s):
            # Kept only where the limits and masses of all joints are known.
            share += (
                " ABOVE ITS LIMIT: torque limits are not kept, `motion.limits` can ask for them"
            )
        lines.append(
            f"torque       largest {worst.largest:.4g} N m by {worst.joint}{share}, mechanical work"
            f" {energy:.4g} J; {s.torque_note}"
        )
    else:
        lines.append(f"torque       unknown: {s.torque_note}")
    return "\n".join(lines)


def kinds_of(summary: MotionSummary) -> list[Kind]:
    """Return the kinds of limits that were checked, in order."""
    return list(dict.fromkeys(use.kind for use in summary.limits))


def tightest(summary: MotionSummary) -> list[LimitUse]:
    """Return the limits that hold the motion back somewhere, that of the largest share first."""
    return sorted((use for use in summary.limits if use.share > 0.0), key=lambda use: -use.share)


def _largest(summary: MotionSummary, kind: Kind) -> str:
    most = max((use for use in summary.limits if use.kind == kind), key=lambda use: use.largest)
    return f"{kind} {most.largest:.1%}" + (f" by {most.joint}" if most.joint else "")


def _held(use: LimitUse) -> str:
    return f"{use.joint or 'the tool'} {use.kind} {use.share:.0%} of the path"


def _metres(distance: float | None) -> str:
    return "unknown" if distance is None else f"{distance:.3f} m"

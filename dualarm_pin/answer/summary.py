"""The summary: a result as a few lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dualarm_pin.answer.alternatives import place_of
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_JOINTS = 4  # named of those that differ
_SENTENCES = 2  # of the evidence: how sure, and what was checked


def summary(task: Task, trajectory: Trajectory) -> str:
    """Return a result as a few lines of text."""
    t, near = trajectory, trajectory.checked.clearance
    clearance = (
        _unknown(task)
        if near is None
        else f"{near.least:.3f} m" + (" (IN COLLISION)" if near.touch else "")
    )
    if t.arm_clearance is not None:
        clearance += f", between the arms {t.arm_clearance:.3f} m"
    clearance += _between(trajectory)
    units = task.index.units
    lines = [
        f"{'found' if t.found else 'NOT FOUND'} by {t.method} ({t.solver})",
        f"index        mean {t.mean_index:.4f}, over the arc length {t.arc_mean_index:.4f}, "
        f"largest {t.max_index:.4f} {units}",
        f"objective    {t.objective:.4f} with lambda {task.smoothness:g}" + _smoothing(t),
        f"pose error   {t.max_position_error:.1e} m, {t.max_rotation_error:.1e} rad",
        f"bounds       violated by {t.max_bound_violation:.1e}, "
        f"largest joint step {t.max_joint_step:.3f} (rad or m)",
        *_rows(trajectory),
        f"clearance    {clearance}",
        f"time         {t.timing.wall_s:.2f} s wall, {t.timing.cpu_s:.2f} s processor"
        + (f", {t.timing.compile_s:.1f} s of it compiling" if t.timing.compile_s else ""),
    ]
    if t.evidence.sentences:
        # The rest is in result.json and the report.
        lines.append("evidence     " + ("\n" + " " * 13).join(_first(t.evidence.sentences)))
    return "\n".join(lines)


def alternatives_text(trajectory: Trajectory) -> str:
    """Return the alternatives of an answer, a line each."""
    if not trajectory.alternatives:
        return "alternatives none that differs in posture was found"
    lines = []
    for number, other in enumerate(trajectory.alternatives, 2):
        t, apart = other.trajectory, other.apart
        names = ", ".join(f"{name} {far:.2f}" for name, far in [*apart.items()][:_JOINTS])
        more = f" and {len(apart) - _JOINTS} more" if len(apart) > _JOINTS else ""
        clearance = "unknown" if t.min_clearance is None else f"{t.min_clearance:.3f} m"
        lines.append(
            f"{place_of(number)}: objective {t.objective:.4f}, clearance {clearance}, "
            f"largest step {t.max_joint_step:.3f}; apart in {names}{more} (rad or m)"
        )
    return "alternatives " + ("\n" + " " * 13).join(lines)


def _smoothing(trajectory: Trajectory) -> str:
    """Return what to know of the objective, where a smooth index was minimised."""
    error = trajectory.checked.smoothing_error
    return f", of a smooth index {error:.1g} from the true one at most" if error else ""


def _unknown(task: Task) -> str:
    """Say why no distance is known: a motion that nobody checked must not look like a free one."""
    missing = task.cell.missing_meshes
    why = f"{len(missing)} bodies could not be loaded" if missing else "the cell has no two bodies"
    return f"unknown, nothing was checked for collision: {why}"


_LEVELS = {
    "points": "looked at the points alone",
    "samples": "sampled, not certified",
    "certified": "certified",
}


def _between(trajectory: Trajectory) -> str:
    """Return what is asked of the distances and what they are between the points."""
    apart = trajectory.checked.apart
    if apart is None:
        return ""
    text, least = "", apart.least_between
    if least is not None:
        text = f"; between the points {least:.3f} m"
    text += f" ({_LEVELS[apart.level]})"
    return text if apart.kept else f"{text}\n{' ' * 13}NOT KEPT: {apart.worst}"


def _first(sentences: str) -> list[str]:
    return sentences.split("\n")[:_SENTENCES]


def _rows(trajectory: Trajectory) -> list[str]:
    """Return a line about the constraint that is nearest to not holding, if there are any."""
    rows = trajectory.checked.rows
    if not rows:
        return []
    broken = max(rows, key=lambda row: row.violation)
    if broken.violation > TOLERANCE.row:
        how = f"VIOLATED: {broken.name} by {broken.violation:.2g} {broken.units}"
        return [f"constraints  {how} at point {broken.worst + 1}"]
    return [f"constraints  {len(rows)} met (violated by {broken.violation:.1e} at most)"]

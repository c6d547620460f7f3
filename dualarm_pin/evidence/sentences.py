"""What the screen says about the evidence: one sentence a line, for a tired engineer.

Words that claim more than was checked have no place here; a test holds the list of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite

from dualarm_pin.answer.evidence import (
    LEAST_SEARCHES,
    SAME_ANSWER,
    Bound,
    LawCount,
    LocalCheck,
    Searches,
)
from dualarm_pin.evidence.laws import LEAST_HITS, LEAST_STARTS

STOPPING_RULE = (
    f"stop when {LEAST_SEARCHES} independent searches or more, and no fewer than half of all, "
    "end at the same best value, or two "
    f"ways of starting have made at least {LEAST_STARTS} starts (1000 for a "
    f"published number), end at the same best path, and each found it at least {LEAST_HITS} "
    "times; if the bound is requested, go on until the gap is under 0.1 % or the budget ends"
)

_FOUND_TWICE = 2  # rounds that found it, each by itself: then nothing speaks for better ones


def tries(found: Searches, laws: Mapping[str, LawCount]) -> str:
    """Say how many tries that shared nothing found the answer, and what to do if it is one."""
    count = len(found.objectives)
    worst = max((each for each in found.above if isfinite(each)), default=0.0)
    others = f"others ended up to {_percent(worst)} above it"
    if worst <= SAME_ANSWER:
        others = "others found no path"
    if found.kind == "searches":
        text = f"{found.hits} of {count} independent searches found this value"
        if found.hits == count:
            return f"{text}."
        return f"{text}, {others}{'' if found.agree else ': a better path may well exist'}."
    rounds = "round" if count == 1 else "rounds"
    text = f"Best of {count} {rounds} of starts and {found.hops} hops"
    if found.hits >= _FOUND_TWICE:
        return f"{text}, found by {found.hits} rounds each by itself."
    if count == 1 and len(laws) > 1:  # another law was asked, and spoke for it
        return f"{text}, where single points have few minima."
    if count == 1:
        return f"{text}, all that there was time for: expect a better one from --effort normal."
    again = "one round alone found it" if found.hits else "no round alone found it"
    return f"{text}; {again}, {others}: expect a better one from --effort normal."


def starts(laws: Mapping[str, LawCount], agree: bool, missed: float | None) -> str:
    """Say how many starts were made, how many ended here, and what they may have missed."""
    if not laws:
        return "No other starts were made: nothing is known of paths elsewhere."
    count = sum(law.starts for law in laws.values())
    hits = " + ".join(str(law.best_hits) for law in laws.values())
    if len(laws) == 1:
        name = next(iter(laws))
        return (
            f"Best of {count} starts (one way, {name}), found {hits} times: this says nothing of "
            "paths that another way of starting would reach."
        )
    ways = {2: "two", 3: "three"}.get(len(laws), str(len(laws))) + " ways"
    if not agree:
        by = ", ".join(f"{name} {law.best_hits} times" for name, law in laws.items())
        return (
            f"Best of {count} starts ({ways}), but no two of them found it ({by}): more starts "
            "are needed."
        )
    share = "" if missed is None else _percent(missed)
    return (
        f"Best of {count} starts ({ways}), found {hits} times: better paths that these starts "
        f"can reach draw under {share} of them (95 %)."
    )


def stopping(met: bool) -> str:
    """Say when to stop, and whether that is now."""
    return f"The rule: {STOPPING_RULE}; {'met here' if met else 'not met here'}."


def bound(bound: Bound, closed: float) -> str:
    """Say what the lower bound is, under which condition, and what the gap means."""
    if bound.without_clearance is not None:
        return _bound_without_clearance(bound, bound.without_clearance, closed)
    least, most = min(bound.hits), max(bound.hits)
    times = f"{least}" if least == most else f"{least} to {most}"
    each = f"{min(bound.starts)} starts" + (" each" if bound.pieces > 1 else "")
    split = (
        f"Splitting into {bound.pieces} pieces" if bound.pieces > 1 else "Searching it anew whole"
    )
    if bound.contradicted:
        return (
            f"{split}: the value {bound.value:.6g} lies above this very path (gap "
            f"{_percent(bound.gap)}), so a {'piece ' if bound.pieces > 1 else ''}search ({each}, "
            f"minimum hit {times} times) missed a minimum, or the bound is wrong: it "
            "bounds nothing."
        )
    text = (
        f"{split}: no better path can exist below {bound.value:.6g} (gap {_percent(bound.gap)}) "
        f"unless a {'piece ' if bound.pieces > 1 else ''}search ({each}, minimum hit {times} "
        "times) missed a minimum"
    )
    if bound.beaten:
        return f"{text}, and a better path was found on the way."
    if not bound.complete:
        return f"{text}; the work was cut short."
    if least < LEAST_HITS:
        return f"{text}, which may well be, with fewer than {LEAST_HITS} hits."
    if bound.gap >= closed:
        return f"{text}; such a gap means that a better path may exist, or that the bound is weak."
    return f"{text}."


def _bound_without_clearance(found: Bound, free: float, closed: float) -> str:
    """Say what a bound of the paths that may collide means for one that may not."""
    text = bound(replace(found, objective=free, without_clearance=None), closed)
    text = f"Without clearance, {text[0].lower()}{text[1:]}"
    if found.contradicted:
        return text
    above = (found.objective - free) / max(abs(free), 1e-12)
    return (
        f"{text} Keeping bodies apart can only raise the objective, so it bounds this answer too "
        f"(gap {_percent(found.gap)}). The answer lies {_percent(above)} above the best path known "
        f"without clearance ({free:.6g}); how much of that is needed is not known."
    )


def local(check: LocalCheck) -> str:
    """Say what the local check found, and which joint limit costs most."""
    if not check.stationary:
        return (
            f"Not yet a minimum: the optimality error is {check.stationarity:.1e} and the pose "
            f"error {check.feasibility:.1e}, so the path can still be improved nearby."
        )
    if not check.minimum:
        return (
            "Not a minimum: the path is stationary, but some small change leads down "
            f"(curvature {check.curvature_min:.1e})."
        )
    kind = "Strict local minimum" if check.strict else "Local minimum, flat in some direction"
    parts = [kind, f"{check.active_bounds} joint limits active"]
    if check.costliest_joint is not None:
        parts.append(f"{check.costliest_joint} costs most")
    if check.return_share < 1.0:
        parts.append(f"{_percent(check.return_share)} of the nearby starts came back to it")
    if check.near_singular:
        parts.append(f"nearly singular at some point (singular value {check.sigma_min:.1e})")
    return ", ".join(parts) + "."


def _percent(share: float) -> str:
    """Return a share as a percentage with two significant digits."""
    return f"{100.0 * share:.2g} %"

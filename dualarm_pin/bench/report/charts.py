"""Charts as inline SVG: performance profiles and maps. They follow the page's light or dark."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from html import escape

Points = Sequence[tuple[float, float]]
Place = tuple[float, float]
# Okabe and Ito without black; dashes for those who see no colour.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8a8f98")
DASHES = ("", "9 4", "3 3", "10 3 2 3", "5 2 2 2 2 2", "14 5", "1 3")
_VIRIDIS = (
    (68, 1, 84),
    (59, 82, 139),
    (33, 145, 140),
    (94, 201, 98),
    (253, 231, 37),
)
_WIDTH, _HEIGHT = 560, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 52, 14, 12, 44


def profile_chart(curves: Mapping[str, Points], label: str) -> str:
    """Return step curves over a logarithmic axis: which share of the runs is within a ratio.

    Args:
        curves: Steps (ratio >= 1, share) by name.
        label: What the horizontal axis says.
    """
    largest = max((ratio for steps in curves.values() for ratio, _ in steps), default=1.0)
    top = max(1.05, largest) * 1.1
    # A chart of one per cent needs ticks between 1 and 1.01, one of a thousand needs decades.
    ticks = _ticks(top)

    def x(ratio: float) -> float:
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * math.log(ratio) / math.log(top)

    def y(share: float) -> float:
        return _TOP + (_HEIGHT - _TOP - _BOTTOM) * (1.0 - share)

    parts = [_open(f"Performance profile: {label}")]
    for tick in ticks:
        parts.append(_line(x(tick), y(0), x(tick), y(1), "grid"))
        parts.append(_text(x(tick), y(0) + 16, f"{tick:g}", "middle"))
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        parts.append(_line(_LEFT, y(share), _WIDTH - _RIGHT, y(share), "grid"))
        parts.append(_text(_LEFT - 6, y(share) + 4, f"{share:.0%}", "end"))
    for number, (name, steps) in enumerate(curves.items()):
        path = [f"M{x(1.0):.1f},{y(0.0):.1f}"]
        for ratio, share in steps:
            path.append(f"H{x(max(ratio, 1.0)):.1f}V{y(share):.1f}")
        path.append(f"H{x(top):.1f}")
        parts.append(
            f'<path class="curve" d="{"".join(path)}" {_look(number)}>'
            f"<title>{escape(name)}</title></path>"
        )
    parts.append(_text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 8, label, "middle"))
    return "".join([*parts, "</svg>"])


def legend(names: Sequence[str]) -> str:
    """Return the key of the curves."""
    items = [
        f'<li><svg viewBox="0 0 34 10" aria-hidden="true"><line x1="0" y1="5" x2="34" y2="5" '
        f'class="curve" {_look(i)}/></svg>'
        f"{escape(name)}</li>"
        for i, name in enumerate(names)
    ]
    return f'<ul class="key">{"".join(items)}</ul>'


def map_chart(
    values: Mapping[Place, float | None],
    label_x: str,
    label_y: str,
    quantity: str,
    crossed: Collection[Place] = (),
) -> str:
    """Return a map of squares over two axes; empty squares are hatched, the least is framed.

    Args:
        values: Value by (x, y); None where nothing was found.
        label_x: What the horizontal axis says.
        label_y: What the vertical axis says.
        quantity: What the colours stand for.
        crossed: Squares with a cross, which cannot be the least.
    """
    xs, ys = sorted({x for x, _ in values}), sorted({y for _, y in values})
    known = [value for value in values.values() if value is not None]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    least = min((v for p, v in values.items() if v is not None and p not in crossed), default=None)
    right = 92  # room for the colour bar
    width, height = _WIDTH - _LEFT - right, max(200.0, 26.0 * len(ys))
    total = height + _TOP + _BOTTOM
    dx, dy = width / len(xs), height / len(ys)
    parts = [_open(f"Map of {quantity}", total)]
    parts.append(
        '<defs><pattern id="none" width="6" height="6" patternUnits="userSpaceOnUse">'
        '<path d="M0,6L6,0" class="hatch"/></pattern></defs>'
    )
    for (x, y), value in values.items():
        left = _LEFT + xs.index(x) * dx
        top = _TOP + height - (ys.index(y) + 1) * dy
        fill = "url(#none)" if value is None else _colour(value, low, high)
        shown = "nothing found" if value is None else f"{value:.4g}"
        bad = (x, y) in crossed
        frame = ' class="least"' if value is not None and value == least and not bad else ""
        parts.append(
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{dx - 1:.1f}" height="{dy - 1:.1f}" '
            f'fill="{fill}"{frame}><title>{escape(f"{label_x} {x:g}, {label_y} {y:g}: {shown}")}'
            "</title></rect>"
        )
        if bad:
            far, bottom = left + dx - 1, top + dy - 1
            parts.append(_line(left, top, far, bottom, "cross"))
            parts.append(_line(left, bottom, far, top, "cross"))
    for i, x in enumerate(xs):
        if i % math.ceil(len(xs) / 8) == 0:
            parts.append(_text(_LEFT + (i + 0.5) * dx, _TOP + height + 16, f"{x:.4g}", "middle"))
    for i, y in enumerate(ys):
        parts.append(_text(_LEFT - 6, _TOP + height - (i + 0.5) * dy + 4, f"{y:.4g}", "end"))
    bar = _WIDTH - right + 14
    for k in range(24):
        value = low + (high - low) * (k + 0.5) / 24
        parts.append(
            f'<rect x="{bar}" y="{_TOP + height * (1 - (k + 1) / 24):.1f}" width="14" '
            f'height="{height / 24 + 0.5:.1f}" fill="{_colour(value, low, high)}"/>'
        )
    for value, place in ((low, _TOP + height), (high, _TOP + 10.0)):
        parts.append(_text(bar + 20, place, f"{value:.3g}", "start"))
    parts.append(_text(_LEFT + width / 2, total - 8, label_x, "middle"))
    parts.append(
        f'<text x="12" y="{_TOP + height / 2:.0f}" text-anchor="middle" '
        f'transform="rotate(-90 12 {_TOP + height / 2:.0f})">{escape(label_y)}</text>'
    )
    return "".join([*parts, "</svg>"])


def _look(number: int) -> str:
    """Return colour and dash of a curve; 49 of them differ."""
    dash = DASHES[(number + number // 7) % 7]
    return f'stroke="{COLOURS[number % 7]}" stroke-dasharray="{dash}"'


def _ticks(top: float) -> list[float]:
    for candidates in (
        (1, 1.01, 1.02, 1.05, 1.1),
        (1, 1.1, 1.2, 1.5, 2),
        (1, 2, 3, 5, 10),
        (1, 3, 10, 30, 100),
        tuple(10.0**k for k in range(0, 13)),
    ):
        if top <= candidates[-1] * 1.6:
            return [tick for tick in candidates if tick < top]
    return [1.0]


def _colour(value: float, low: float, high: float) -> str:
    share = (value - low) / (high - low) if high > low else 0.0
    place = (1.0 - min(max(share, 0.0), 1.0)) * (len(_VIRIDIS) - 1)  # bright is good
    k = min(int(place), len(_VIRIDIS) - 2)
    mixed = (
        round(a + (place - k) * (b - a)) for a, b in zip(_VIRIDIS[k], _VIRIDIS[k + 1], strict=True)
    )
    return f"rgb({','.join(str(part) for part in mixed)})"


def _open(title: str, height: float = _HEIGHT) -> str:
    return (
        f'<svg class="chart" viewBox="0 0 {_WIDTH} {height:.0f}" role="img" '
        f'aria-label="{escape(title, quote=True)}">'
    )


def _line(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    return f'<line class="{kind}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'

"""Curves over time as drawings for a page: each stretches to its frame, labels stand beside it."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from common.body.body import Vector

WIDE, HIGH = 1000.0, 100.0
"""Size of a drawing in its own units."""
MOST_POINTS: Final = 1200
"""Largest number of points of a curve; of longer ones the lowest and highest of each part."""
STEPS: Final = (1.0, 2.0, 5.0)
"""Steps between ticks, times a power of ten."""
TICKS: Final = 4
"""About as many."""


class Curve(NamedTuple):
    """One quantity over another."""

    x: Vector
    """(n,) increasing."""
    y: Vector
    """(n,) NaN where it is not known."""
    look: str
    """Classes that style it: left, right, trunk, quiet, dashed."""
    bands: tuple[Vector, ...] = ()
    """(n,) half widths of bands around it, the narrowest last; NaN where there is none."""


class Tick(NamedTuple):
    """A label at an axis."""

    at: float
    """Percent from the left, or from the top."""
    text: str


class Chart(NamedTuple):
    """A drawing with its axes."""

    title: str
    unit: str
    drawing: Markup
    across: tuple[Tick, ...]
    up: tuple[Tick, ...]


def chart(
    title: str, unit: str, curves: Sequence[Curve], x_span: tuple[float, float], least: float
) -> Chart:
    """Curves in one frame.

    Args:
        title: Name of the quantity.
        unit: Unit of the quantity.
        curves: Those drawn last are on top.
        x_span: Ends of the frame across.
        least: Smallest height of the frame, in the unit: noise is not enlarged to its full height.
    """
    edges = [
        curve.y + way * band for curve in curves for band in curve.bands[-1:] for way in (-1, 1)
    ]
    y_span = _span([*(curve.y for curve in curves), *edges], least)
    up = ticks(*y_span)
    grid = "".join(f'<path class="grid" d="M0 {tick.at:.1f}H{WIDE:.0f}"/>' for tick in _down(up))
    drawn = [_drawn(curve, x_span, y_span) for curve in curves]
    bands = "".join(part for bands, _ in drawn for part in bands)
    lines = "".join(line for _, line in drawn)
    svg = Markup(
        f'<svg viewBox="0 0 {WIDE:.0f} {HIGH:.0f}" preserveAspectRatio="none" aria-hidden="true">'
        f"{grid}{bands}{lines}</svg>"
    )
    return Chart(title, unit, svg, ticks(*x_span), _down(up))


def ticks(low: float, high: float) -> tuple[Tick, ...]:
    """Round numbers in a span, at their percent of it."""
    rough = max(high - low, 1e-9) / TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next((power * one for one in STEPS if power * one >= rough), 10.0 * power)
    first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
    return tuple(
        Tick(100.0 * (n * step - low) / (high - low), f"{n * step:g}")
        for n in range(first, last + 1)
    )


def _down(up: tuple[Tick, ...]) -> tuple[Tick, ...]:
    """Ticks counted from the top."""
    return tuple(Tick(100.0 - tick.at, tick.text) for tick in up)


def _span(values: Sequence[Vector], least: float) -> tuple[float, float]:
    """Lowest and highest value with a margin; around 0 where there is none."""
    known = np.concatenate([part[np.isfinite(part)] for part in values] or [np.zeros(0)])
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 0.0)
    middle, half = (low + high) / 2, max(high - low, least) * 0.54
    return middle - half, middle + half


def _drawn(
    curve: Curve, x_span: tuple[float, float], y_span: tuple[float, float]
) -> tuple[list[str], str]:
    """The areas of its bands, and its line."""
    kept = thinned(curve.y)
    x = WIDE * (curve.x[kept] - x_span[0]) / max(x_span[1] - x_span[0], 1e-9)

    def down(y: Vector) -> Vector:
        return np.clip(HIGH * (y_span[1] - y) / (y_span[1] - y_span[0]), -1.0, HIGH + 1.0)

    y, bands = curve.y[kept], []
    for half in (band[kept] for band in curve.bands):
        d = _area(x, down(y - half), down(y + half))
        bands.append(f'<path class="band {curve.look}" d="{d}"/>')
    return bands, f'<path class="line {curve.look}" d="{_line(x, down(y))}"/>'


def thinned(y: Vector) -> NDArray[np.intp]:
    """The points of a curve to draw: all, or the lowest and highest of each part, in order."""
    n = len(y)
    if n <= MOST_POINTS:
        return np.arange(n)
    kept: list[int] = [0, n - 1]
    for part in np.array_split(np.arange(n), MOST_POINTS // 2):
        own = y[part]
        known = part[np.isfinite(own)]
        if len(known) < len(part):
            kept.append(int(part[np.flatnonzero(~np.isfinite(own))[0]]))
        if len(known):
            kept += [int(known[np.argmin(y[known])]), int(known[np.argmax(y[known])])]
    return np.unique(kept)


def stretches(known: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First index, and that after the last, of each stretch in which all is known."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _line(x: Vector, y: Vector) -> str:
    return "".join(
        "M" + "L".join(_points(x[a:b], y[a:b])) + ("h0.01" if b - a == 1 else "")
        for a, b in stretches(np.isfinite(y))
    )


def _area(x: Vector, low: Vector, high: Vector) -> str:
    return "".join(
        f"M{'L'.join([*_points(x[a:b], high[a:b]), *_points(x[a:b], low[a:b])[::-1]])}Z"
        for a, b in stretches(np.isfinite(low + high))
        if b - a > 1
    )


def _points(x: Vector, y: Vector) -> list[str]:
    return [f"{a:.1f} {b:.2f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)]

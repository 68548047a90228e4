"""Line charts over mission time as inline SVG: no script, no outside file, colours by style sheet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from explore_bt.report.words import clock

__all__ = ["Series", "chart"]

_WIDTH, _HEIGHT = 420, 210
_LEFT, _RIGHT, _TOP, _BOTTOM = 44, 10, 10, 26
_MOST_POINTS = 400


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """One line: (N,) float64 seconds and values; NaN values are gaps."""

    name: str
    colour: str
    stamps_s: NDArray[np.float64]
    values: NDArray[np.float64]


def chart(title: str, unit: str, series: Sequence[Series], end_s: float, top: float | None = None) -> str:
    """A titled chart from 0 to ``end_s``; the y axis begins at 0 and ends at ``top`` or above the data."""
    finite = np.concatenate([line.values[np.isfinite(line.values)] for line in series])
    if not len(finite):
        return ""
    high = top if top is not None else max(float(finite.max()) * 1.05, 1e-6)
    span_s = max(end_s, 1e-6)
    parts = [
        _grid_lines(high, unit),
        _time_axis(span_s),
        *(_line(one, span_s, high, filled=len(series) == 1) for one in series),
        f'<line class="cursor" x1="{_LEFT}" x2="{_LEFT}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}" '
        f'data-left="{_LEFT}" data-right="{_WIDTH - _RIGHT}"/>',
    ]
    label = escape(f"{title} in {unit} over mission time", quote=True)
    svg = f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{label}">{"".join(parts)}</svg>'
    return (
        f'<figure class="chart"><figcaption>{escape(title)} <span>{escape(unit)}</span></figcaption>'
        f"{svg}</figure>"
    )


def _step(span: float, most: int) -> float:
    """The smallest of 1, 2, 5 × 10ⁿ that needs at most ``most`` steps."""
    power = 10.0 ** math.floor(math.log10(span / most))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power * most >= span * 0.999)


def _time_step_s(span_s: float) -> float:
    nice = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 43200)
    return float(next((step for step in nice if step * 6 >= span_s), _step(span_s, 6)))


def _x(stamp_s: float, span_s: float) -> float:
    return _LEFT + stamp_s / span_s * (_WIDTH - _LEFT - _RIGHT)


def _y(value: float, high: float) -> float:
    return _HEIGHT - _BOTTOM - value / high * (_HEIGHT - _TOP - _BOTTOM)


def _grid_lines(high: float, unit: str) -> str:
    step = 25.0 if unit == "%" else _step(high, 4)
    lines = []
    for k in range(int(high / step + 1e-9) + 1):
        y = _y(k * step, high)
        lines.append(
            f'<line class="rule" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>'
            f'<text x="{_LEFT - 6}" y="{y + 3.5:.1f}" text-anchor="end">{k * step:g}</text>'
        )
    return "".join(lines)


def _time_axis(span_s: float) -> str:
    step_s = _time_step_s(span_s)
    stamps = [k * step_s for k in range(int(span_s / step_s + 1e-9) + 1)]
    place = f'y="{_HEIGHT - 8}" text-anchor="middle"'
    return "".join(f'<text x="{_x(stamp, span_s):.1f}" {place}>{clock(stamp)}</text>' for stamp in stamps)


def _line(series: Series, span_s: float, high: float, filled: bool) -> str:
    runs: list[list[str]] = [[]]
    ends: list[tuple[float, float]] = []
    every = max(1, len(series.stamps_s) // _MOST_POINTS)
    # the last sample is always shown, whatever the thinning leaves
    kept = np.unique(np.append(np.arange(0, len(series.stamps_s), every), len(series.stamps_s) - 1))
    for stamp_s, value in zip(series.stamps_s[kept].tolist(), series.values[kept].tolist(), strict=True):
        if math.isfinite(value):
            x = _x(stamp_s, span_s)
            runs[-1].append(f"{x:.1f},{_y(min(max(value, 0.0), high), high):.1f}")
            ends = [(ends[0][0] if len(runs[-1]) > 1 else x, x)]
        elif runs[-1]:
            runs.append([])
    name, style = f"<title>{escape(series.name)}</title>", f'style="stroke:{series.colour}"'
    lines = "".join(f'<polyline {style} points="{" ".join(run)}">{name}</polyline>' for run in runs if run)
    floor = _HEIGHT - _BOTTOM
    if filled and len([run for run in runs if run]) == 1:
        left, right = ends[0]
        area = f"{left:.1f},{floor} {' '.join(runs[0])} {right:.1f},{floor}"
        return f'<polygon style="fill:{series.colour}" points="{area}"/>{lines}'
    return lines

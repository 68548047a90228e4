"""The strip below: coverage and speed over the whole run, interventions, events, and where we are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.export.video.canvas import Canvas, rgb
from explore_bt.export.video.scene import Scene
from explore_bt.report.words import clock, length

__all__ = ["Timeline", "TimelinePane"]

_PAPER, _INK, _SOFT, _LINE = rgb("#f6f8fa"), rgb("#16202c"), rgb("#5d6b7a"), rgb("#d5dce3")
_COVERAGE, _SPEED, _WARNING, _ERROR = rgb("#2f6fed"), rgb("#d9730d"), rgb("#d9730d"), rgb("#d7263d")
_LEFT, _RIGHT, _TOP, _BOTTOM = 12, 12, 46, 12


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """What is known of the whole run: of the first robot.

    Attributes:
        states: (N, 3) float64: seconds, coverage (NaN: nobody knows), speed in m/s.
        events: seconds and level of each warning and error.
    """

    end_s: float
    states: NDArray[np.float64]
    events: Sequence[tuple[float, int]]


class TimelinePane:
    """Draws into a box of a canvas."""

    def __init__(self, box: tuple[int, int, int, int], timeline: Timeline) -> None:
        self._box = box
        self._timeline = timeline

    def draw(self, canvas: Canvas, scene: Scene, stamp_s: float) -> None:
        """The whole run, and a line at this moment."""
        canvas.fill(self._box, _PAPER)
        left, top, width, height = self._box
        self._draw_words(canvas, scene, stamp_s)
        floor = top + height - _BOTTOM
        canvas.line(np.array(((left + _LEFT, floor), (left + width - _RIGHT, floor)), dtype=float), _LINE)
        states = self._timeline.states
        fastest = max(float(np.nanmax(np.abs(states[:, 2]), initial=0.0)), 1e-6)
        self._draw_curve(canvas, states[:, 0], np.abs(states[:, 2]) / fastest * 0.5, _SPEED)
        self._draw_curve(canvas, states[:, 0], states[:, 1], _COVERAGE)
        for event_s, level in self._timeline.events:
            x = self._x(event_s)
            canvas.line(np.array(((x, floor - 6.0), (x, floor + 4.0))), _ERROR if level > 3 else _WARNING, 2)
        x = self._x(stamp_s)
        canvas.line(np.array(((x, top + _TOP - 4.0), (x, floor + 4.0))), _INK, 2)

    def _x(self, stamp_s: float) -> float:
        left, _, width, _ = self._box
        return left + _LEFT + stamp_s / max(self._timeline.end_s, 1e-6) * (width - _LEFT - _RIGHT)

    def _draw_curve(
        self,
        canvas: Canvas,
        stamps_s: NDArray[np.float64],
        shares: NDArray[np.float64],
        colour: tuple[int, int, int],
    ) -> None:
        _, top, _, height = self._box
        known = np.isfinite(shares)
        x = np.array([self._x(stamp_s) for stamp_s in stamps_s[known].tolist()])
        y = top + height - _BOTTOM - shares[known] * (height - _TOP - _BOTTOM)
        canvas.line(np.column_stack((x, y)), colour, 2)

    def _draw_words(self, canvas: Canvas, scene: Scene, stamp_s: float) -> None:
        left, top, width, _ = self._box
        state = next(iter(scene.robots.values())).state if scene.robots else {}
        parts = [clock(stamp_s)]
        if state.get("coverage") is not None:
            parts.append(f"{100.0 * state['coverage']:.0f} % mapped")
        if state:
            parts += [length(state["distance_m"]), f"{abs(state['speed_mps']):.2f} m/s", state["health"]]
        canvas.text((left + _LEFT, top + 6), "  ·  ".join(parts), _INK, 15, bold=True)
        if scene.events:
            words = canvas.cut_to(scene.events[-1][1].replace("\n", " "), width - _LEFT - _RIGHT)
            canvas.text((left + _LEFT, top + 27), words, _SOFT)

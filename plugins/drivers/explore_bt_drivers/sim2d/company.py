"""The other robots in a robot's world, as its lidar meets them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.people.ways import Ways
from explore_bt_drivers.sim2d.body import Body, Track
from explore_bt_drivers.sim2d.motion import STEP_S, X, Y

__all__ = ["Company"]


class Company:
    """Discs on the ways that they have come; all must have moved on to the end of a sweep."""

    def __init__(self, bodies: Sequence[Body]) -> None:
        """Look out for these, and for those who join them; the robot itself is told apart by its track."""
        self._bodies = bodies

    def ways(self, track: Track, begin_s: float, end_s: float, limit_m: float) -> Ways | None:
        """Where those that may be in sight went between two times; None where none is near.

        Args:
            track: of the robot that looks.
            begin_s: of a sweep.
            end_s: of the same.
            limit_m: how far its lidar sees.
        """
        others = [body for body in self._bodies if body.track is not track and _is_near(body, track, limit_m)]
        return _ways_of(others, begin_s, end_s) if others else None


def _is_near(body: Body, track: Track, limit_m: float) -> bool:
    """Whether it may be in sight; a metre more is farther than anybody goes in a sweep out of it."""
    x, y = track.now[[X, Y]].tolist()
    return math.dist(body.xy, (x, y)) <= limit_m + body.radius_m + 1.0 + 2.0 * body.speed_limit_mps


def _ways_of(bodies: Sequence[Body], begin_s: float, end_s: float) -> Ways:
    knots = [_knots(body.track, begin_s, end_s) for body in bodies]
    return Ways(
        np.concatenate(knots),
        np.cumsum([0, *(len(each) for each in knots)], dtype=np.int64),
        np.array([body.radius_m for body in bodies], dtype=np.float64),
    )


def _knots(track: Track, begin_s: float, end_s: float) -> NDArray[np.float64]:
    """(N, 3) seconds, x, y of the states around a time; at least two."""
    first = max(math.floor(begin_s / STEP_S) - 1, track.first_step)
    last = min(max(math.ceil(end_s / STEP_S), first + 1), track.last_step)
    rows = track.states[first - track.first_step : last - track.first_step + 1, [X, Y]]
    knots = np.column_stack((np.arange(first, first + len(rows)) * STEP_S, rows))
    return knots if len(knots) > 1 else np.vstack((knots - (STEP_S, 0.0, 0.0), knots))

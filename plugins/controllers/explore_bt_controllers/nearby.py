"""What stands and what moves around the robot, as rollouts need it."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Surroundings
from explore_bt.types import OCCUPIED, UNKNOWN, MovingObstacle
from explore_bt_controllers.rollout import Field

__all__ = ["Nearby"]

_REACH_M = 3.0
_CELL_M = 0.04
_OF_IT_M = 0.15  # returns this far beyond the radius of a moving obstacle still are its own
_FAR_M = 100.0
_NOWHERE = Field(np.full((2, 2), _FAR_M, dtype=np.float32), 0.0, 0.0, 1.0)


class Nearby:
    """The newest surroundings; before the first, there is nothing."""

    def __init__(self) -> None:
        self._surroundings: Surroundings | None = None
        self._field: Field | None = _NOWHERE

    def see(self, surroundings: Surroundings) -> None:
        """Take note; the work is done when somebody asks."""
        self._surroundings, self._field = surroundings, None

    def field(self, x: float, y: float) -> Field:
        """Distances to what stands, 3 m around; (x, y) metres is where the robot is."""
        if self._field is None:
            assert self._surroundings is not None
            self._field = _field_of(self._surroundings, x, y)
        return self._field

    @property
    def moving(self) -> tuple[MovingObstacle, ...]:
        """What moves."""
        return self._surroundings.moving if self._surroundings else ()

    def moving_at(
        self, times_s: NDArray[np.float64], reach_m: float, soft_m: float, doubt_mps: float
    ) -> NDArray[np.float64]:
        """(K, M, 4) float64, metres: x, y, distance of centres that counts as touching, band avoided beyond it.

        Args:
            times_s: (K,) float64; the doubt begins with the first.
            reach_m: from the robot's centre to what must not be touched.
            soft_m: width of the band at first.
            doubt_mps: growth of the band.
        """
        at = np.empty((len(times_s), len(self.moving), 4))
        for m, obstacle in enumerate(self.moving):
            at[:, m, 0], at[:, m, 1] = obstacle.at(times_s)
            at[:, m, 2] = obstacle.radius_m + reach_m
            at[:, m, 3] = soft_m + doubt_mps * (times_s - times_s[0])
        return at


def _field_of(surroundings: Surroundings, x: float, y: float) -> Field:
    """An obstacle that points show is where they are; the map has the rest, in coarser cells."""
    count = round(2.0 * _REACH_M / _CELL_M)
    x0, y0 = x - _REACH_M, y - _REACH_M
    cells = _cells_around(surroundings, x0, y0, count)
    own = np.zeros((count, count), dtype=np.uint8)  # of moving obstacles
    for obstacle in surroundings.moving:
        ox, oy = obstacle.at(surroundings.stamp_s)
        centre = (math.floor((ox - x0) / _CELL_M), math.floor((oy - y0) / _CELL_M))
        cv2.circle(own, centre, math.ceil((obstacle.radius_m + _OF_IT_M) / _CELL_M), 1, -1)
    at = np.floor((surroundings.points - (x0, y0)) / _CELL_M).astype(np.int64)
    at = at[((at >= 0) & (at < count)).all(axis=1)]
    shown = np.zeros((count, count), dtype=np.uint8)
    shown[at[:, 1], at[:, 0]] = 1
    spread = 2 * round(1.5 * surroundings.grid.resolution_m / _CELL_M) + 1
    explained = cv2.dilate(shown, np.ones((spread, spread), dtype=np.uint8)) | own
    taken = (cells == UNKNOWN) | ((cells == OCCUPIED) & (explained == 0)) | ((shown & ~own) == 1)
    free = np.logical_not(taken).astype(np.uint8)
    room = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return Field(room * np.float32(_CELL_M), x0 + 0.5 * _CELL_M, y0 + 0.5 * _CELL_M, _CELL_M)


def _cells_around(surroundings: Surroundings, x0: float, y0: float, count: int) -> NDArray[np.int8]:
    """(count, count) int8: the map in the field's cells; outside it is unknown."""
    grid = surroundings.grid
    middles = (np.arange(count) + 0.5) * _CELL_M
    cols = np.floor((x0 + middles - grid.origin_xy[0]) / grid.resolution_m).astype(np.int64)
    rows = np.floor((y0 + middles - grid.origin_xy[1]) / grid.resolution_m).astype(np.int64)
    known_rows = (rows >= 0) & (rows < grid.shape[0])
    known_cols = (cols >= 0) & (cols < grid.shape[1])
    out = np.full((count, count), UNKNOWN, dtype=np.int8)
    out[np.ix_(known_rows, known_cols)] = grid.cells[np.ix_(rows[known_rows], cols[known_cols])]
    return out

"""What stands and what moves around the robot, as rollouts need it."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.interfaces import Surroundings
from explore_bt.types import FREE, OCCUPIED, MovingObstacle
from explore_bt_controllers.rollout import Field

__all__ = ["Nearby"]

_REACH_M = 2.4  # five seconds at 0.5 m/s; what is further is looked at in time
_CELL_M = 0.04
_COUNT = 120  # R: cells across the field
_OF_IT_M = 0.15  # returns this far beyond the radius of a moving obstacle still are its own
_FAR_M = 100.0
_NOT_FOUND, _STEP = np.int32(2500), np.int32(1)  # cells: as far as _FAR_M, and one
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
        """Distances to what stands, 2.4 m around; (x, y) metres is where the robot is."""
        if self._field is None:
            assert self._surroundings is not None
            self._field = _field_of(self._surroundings, x, y)
        return self._field

    def room_at(self, points: NDArray[np.float64], x: float, y: float) -> NDArray[np.float64]:
        """(N,) metres in the cells of (N, 2) points; those outside the field are taken for its edge."""
        field = self.field(x, y)
        at = np.rint((points - (field.x0, field.y0)) / field.resolution).astype(np.int64)
        last = len(field.room) - 1
        return field.room[at[:, 1].clip(0, last), at[:, 0].clip(0, last)].astype(np.float64)

    @property
    def moving(self) -> tuple[MovingObstacle, ...]:
        """What moves."""
        return self._surroundings.moving if self._surroundings else ()

    def moving_at(
        self, times_s: NDArray[np.float64], reach_m: float, soft_m: float, doubt_mps: float
    ) -> NDArray[np.float64]:
        """(K, M, 4) float64, metres: x, y, distance of centres that is touching, width of the band avoided.

        Args:
            times_s: (K,) float64; the doubt begins with the first.
            reach_m: from the robot's centre to what must not be touched.
            soft_m: width of the band at first.
            doubt_mps: growth of the band.
        """
        at = np.empty((len(times_s), len(self.moving), 4))
        for m, obstacle in enumerate(self.moving):
            ahead_s = times_s - obstacle.stamp_s
            at[:, m, 0] = obstacle.xy[0] + ahead_s * obstacle.velocity_mps[0]
            at[:, m, 1] = obstacle.xy[1] + ahead_s * obstacle.velocity_mps[1]
            at[:, m, 2] = obstacle.radius_m + reach_m
            at[:, m, 3] = soft_m + doubt_mps * (times_s - times_s[0])
        return at


def _field_of(surroundings: Surroundings, x: float, y: float) -> Field:
    """An obstacle that points show is where they are; the map has the rest, in coarser cells."""
    grid = surroundings.grid
    x0, y0 = x - _REACH_M, y - _REACH_M
    own = np.zeros((_COUNT, _COUNT), dtype=np.uint8)  # of moving obstacles
    for obstacle in surroundings.moving:
        ox, oy = obstacle.at(surroundings.stamp_s)
        centre = (math.floor((ox - x0) / _CELL_M), math.floor((oy - y0) / _CELL_M))
        cv2.circle(own, centre, math.ceil((obstacle.radius_m + _OF_IT_M) / _CELL_M), 1, -1)
    shown = _shown(surroundings.points, x0, y0)
    reach = round(1.5 * grid.resolution_m / _CELL_M)
    near = cv2.dilate(shown, np.ones((2 * reach + 1, 2 * reach + 1), dtype=np.uint8))
    free = _free(grid.cells, *grid.origin_xy, grid.resolution_m, x0, y0, own, shown, near)
    return Field(_room(free), x0 + 0.5 * _CELL_M, y0 + 0.5 * _CELL_M, _CELL_M)


@njit(cache=True)
def _shown(points, x0, y0):  # type: ignore[no-untyped-def]  # numba kernel
    """(R, R) uint8: cells that hold one of (N, 2) points."""
    shown = np.zeros((_COUNT, _COUNT), dtype=np.uint8)
    for k in range(len(points)):
        i, j = math.floor((points[k, 1] - y0) / _CELL_M), math.floor((points[k, 0] - x0) / _CELL_M)
        if 0 <= i < _COUNT and 0 <= j < _COUNT:
            shown[i, j] = 1
    return shown


@njit(cache=True)
def _free(cells, map_x, map_y, resolution, x0, y0, own, shown, near):  # type: ignore[no-untyped-def]  # numba kernel
    """(R, R) uint8: where nothing stands; unknown places count as obstacles.

    Args:
        cells: of the map.
        map_x: x of its lower left corner, metres.
        map_y: y of it.
        resolution: metres per cell of the map.
        x0: x of the field's lower left corner, metres.
        y0: y of it.
        own: (R, R) uint8, 1 where a moving obstacle is.
        shown: 1 where a point is.
        near: 1 so near to a point that an occupied cell of the map is the same thing.
    """
    free = np.zeros((_COUNT, _COUNT), dtype=np.uint8)
    for i in range(_COUNT):
        row = math.floor((y0 + (i + 0.5) * _CELL_M - map_y) / resolution)
        for j in range(_COUNT):
            col = math.floor((x0 + (j + 0.5) * _CELL_M - map_x) / resolution)
            if 0 <= row < cells.shape[0] and 0 <= col < cells.shape[1]:
                is_explained = own[i, j] or near[i, j]
                is_known = cells[row, col] == FREE or (cells[row, col] == OCCUPIED and is_explained)
                free[i, j] = is_known and (own[i, j] or not shown[i, j])
    return free


@njit(cache=True)
def _room(free):  # type: ignore[no-untyped-def]  # numba kernel
    """(R, R) float32, metres from each cell to the nearest that is not free; exact, and always the same bits.

    cv2's precise transform is not: its last digit depends on where in memory the image lies, and one digit is
    enough for another course among people.
    """
    count = free.shape[0]
    steps = np.empty((count, count), np.int32)  # to the nearest one in the column
    for i in range(count):
        for j in range(count):
            before = steps[i - 1, j] if i > 0 else _NOT_FOUND
            steps[i, j] = min(before + _STEP, _NOT_FOUND) if free[i, j] else np.int32(0)
    for i in range(count - 2, -1, -1):
        for j in range(count):
            steps[i, j] = min(steps[i, j], steps[i + 1, j] + _STEP)
    room = np.empty((count, count), np.float32)
    wide = np.full(3 * count, _NOT_FOUND * _NOT_FOUND, np.int32)  # a row of squares, nothing on either side
    best = np.empty(count, np.int32)
    for i in range(count):
        for j in range(count):
            best[j] = wide[count + j] = steps[i, j] * steps[i, j]
        reach, farthest = 1, best.max()
        while reach < count and reach * reach < farthest:
            square = np.int32(reach * reach)
            left, right = wide[count - reach :], wide[count + reach :]
            for j in range(count):
                best[j] = min(best[j], min(left[j], right[j]) + square)
            if reach % 4 == 0:
                farthest = best.max()
            reach += 1
        for j in range(count):
            room[i, j] = np.float32(_CELL_M) * np.sqrt(np.float32(best[j]))
    return room

"""Where to step aside: the near place that keeps farthest from where people are heading."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.travel import Travel
from explore_bt.types import MovingObstacle, OccupancyGrid

__all__ = ["find_refuge", "gap_to_courses_m"]

COURSE_M = 8.0
"""So far ahead a course is thought to be kept: nobody is outrun along it."""
_WALKS_MPS = 0.2
_GAIN_M = 0.15
"""A place must keep so much farther off than the robot does where it stands."""
_WAY_WEIGHT = 0.1
"""Metres of gap that a metre of way must win."""


def gap_to_courses_m(places_xy: NDArray[np.float64], moving: Sequence[MovingObstacle]) -> NDArray[np.float64]:
    """(N,) metres from (N, 2) places to the nearest course: the next ``COURSE_M`` of someone who goes on.

    Who stands has a course of one place. Without anyone the gap is infinite.
    """
    gap_m = np.full(len(places_xy), np.inf)
    for thing in moving:
        begin = np.array(thing.xy)
        speed_mps = math.hypot(*thing.velocity_mps)
        course = np.array(thing.velocity_mps) * (COURSE_M / speed_mps if speed_mps > _WALKS_MPS else 0.0)
        share = np.clip((places_xy - begin) @ course / max(float(course @ course), 1e-9), 0.0, 1.0)
        off = places_xy - begin - share[:, None] * course
        gap_m = np.minimum(gap_m, np.hypot(off[:, 0], off[:, 1]) - thing.radius_m)
    return gap_m


def find_refuge(
    grid: OccupancyGrid,
    clearance_m: NDArray[np.float32],
    here_xy: tuple[float, float],
    moving: Sequence[MovingObstacle],
    radius_m: float,
    *,
    most_way_m: float = 3.0,
    enough_m: float = 0.6,
) -> tuple[float, float] | None:
    """A place clear of all courses that the robot reaches before anyone does; None if here is as good.

    In a corridor that is a side branch: along it every place lies on the course.

    Args:
        grid: the map.
        clearance_m: (rows, cols) float32, as from :func:`clearance_field`.
        here_xy: the robot, metres, ``map`` frame.
        moving: who moves.
        radius_m: the footprint with what it shall have to spare.
        most_way_m: no farther away than this.
        enough_m: beyond the footprint; a larger gap is not worth a way.
    """
    row, col = grid.cell_of(*here_xy)
    window = grid.window_around(*here_xy, most_way_m)
    near_m = np.ascontiguousarray(clearance_m[window.slices])
    here = (row - window.row0, col - window.col0)
    way_m = Travel(near_m, radius_m, grid.resolution_m).field(here, most_way_m)
    cells = np.argwhere(way_m <= most_way_m)
    if not len(cells):
        return None
    places, ways_m = grid.centers_of(cells + np.array([window.row0, window.col0])), way_m[tuple(cells.T)]
    is_refuge = np.ones(len(places), dtype=np.bool_)
    for thing in moving:
        is_refuge &= np.hypot(*(places - thing.xy).T) - thing.radius_m > ways_m
    most_m = radius_m + enough_m
    gap_m = gap_to_courses_m(places, moving)
    is_refuge &= gap_m >= radius_m
    worth_m = np.minimum(gap_m, most_m) - _WAY_WEIGHT * ways_m
    here_m = float(np.minimum(gap_to_courses_m(np.array([here_xy]), moving), most_m)[0])
    best = int(np.argmax(np.where(is_refuge, worth_m, -np.inf)))
    if not is_refuge[best] or worth_m[best] < here_m + _GAIN_M:
        return None
    x, y = places[best].tolist()
    return (x, y)

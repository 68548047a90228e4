"""Paths through tight places, moved to the middle of what the scan shows there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration import clearance_at
from explore_bt.types import OccupancyGrid, Path, way_along

__all__ = ["centred"]

_TIGHT_M = 0.05
"""A pose with less than this to spare is moved."""
_MOST_M = 0.06
_STEP_M = 0.005
_TAPER_M = 0.3
_REACH_M = 1.0


def centred(path: Path, points: NDArray[np.float64], grid: OccupancyGrid, radius_m: float) -> Path:
    """The path with its tight poses moved aside to where the scan leaves most room.

    A path on the map lies in the middle to half a cell, and a robot that fits a gap by 2 cm is refused 2 cm
    beside its middle. What the map knows alone, and the path's ends, stay as they are.

    Args:
        path: as planned on the map.
        points: (N, 2) float64, metres, ``map`` frame: the newest scan's returns.
        grid: the map.
        radius_m: the footprint.
    """
    tight = np.flatnonzero(path.clearance_m < radius_m + _TIGHT_M)
    if len(path.poses) < 3 or not tight.size or not len(points):
        return path
    xy = path.poses[:, :2]
    along = np.gradient(xy, axis=0)
    along /= np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)[:, None]
    aside = np.column_stack((-along[:, 1], along[:, 0]))
    offsets_m = np.array([_to_the_middle(xy[i], aside[i], points, radius_m) for i in tight])
    moved_xy = xy + _tapered(way_along(xy), tight, offsets_m)[:, None] * aside
    poses = path.poses.copy()
    poses[:, :2] = moved_xy
    steps = np.gradient(moved_xy, axis=0)
    poses[1:-1, 2] = np.arctan2(steps[1:-1, 1], steps[1:-1, 0])
    known_m = clearance_at(grid, moved_xy, radius_m + _TIGHT_M)
    return Path(poses, np.minimum(path.clearance_m, np.maximum(known_m, 0.0)))


def _to_the_middle(
    xy: NDArray[np.float64], aside: NDArray[np.float64], points: NDArray[np.float64], radius_m: float
) -> float:
    """How far aside the nearest return is farthest off; 0 where there is none that matters."""
    near = points[np.hypot(*(points - xy).T) < _REACH_M]
    if not len(near):
        return 0.0
    offsets_m = np.arange(-_MOST_M, _MOST_M + 0.5 * _STEP_M, _STEP_M)
    places = xy + offsets_m[:, None] * aside
    apart = places[:, None] - near[None]
    room_m = np.hypot(apart[..., 0], apart[..., 1]).min(axis=1)
    if room_m[len(room_m) // 2] > radius_m + _TIGHT_M:
        return 0.0
    return float(offsets_m[np.argmax(room_m - 0.01 * np.abs(offsets_m))])


def _tapered(
    way_m: NDArray[np.float64], tight: NDArray[np.int64], offsets_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(N,) offsets for all poses: of the tight ones smoothed, fading out before and behind them."""
    found = np.interp(way_m, way_m[tight], offsets_m)
    smooth = np.array([found[np.abs(way_m - at) <= 0.5 * _TAPER_M].mean() for at in way_m])
    away_m = np.abs(way_m[:, None] - way_m[tight][None]).min(axis=1)
    to_end_m = np.minimum(way_m, way_m[-1] - way_m)
    fade = np.clip(1.0 - away_m / _TAPER_M, 0.0, 1.0) * np.clip(to_end_m / _TAPER_M, 0.0, 1.0)
    return np.asarray(smooth * fade)

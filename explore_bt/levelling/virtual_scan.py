"""A planar scan made from a level 3D sweep, for the registration that planar lidars use."""

from __future__ import annotations

import numpy as np
from numba import njit

from explore_bt.levelling.arrays import Floats, Singles
from explore_bt.levelling.level_cloud import LevelCloud
from explore_bt.types import Scan2D

__all__ = ["virtual_scan"]

_BINS = 720


def virtual_scan(
    cloud: LevelCloud,
    low_m: float,
    high_m: float,
    range_max_m: float,
    *,
    rise: float = 0.0,
    surface_m: float = 0.0,
    bins: int = _BINS,
) -> Scan2D:
    """In each of 720 directions the nearest return between two heights above the floor.

    A direction in which only other heights returned something says "nothing within range"; one without any
    return is invalid. Beams keep the direction and time of their return, so that they are deskewed like any
    other scan's; they start in ``base_link``.

    Args:
        cloud: the sweep.
        low_m: the lower height.
        high_m: the higher one.
        range_max_m: of the lidar.
        rise: by so much for every metre away the lower height is higher, metres.
        surface_m: returns so little farther than the nearest are of the same surface, and their mean counts:
            the nearest of many noisy ones is always too near.
        bins: how many directions.
    """
    angles, ranges, times = _nearest(cloud.own, cloud.times_s, low_m, high_m, rise, bins)
    if surface_m > 0.0:
        ranges = _averaged(cloud.own, ranges, low_m, high_m, rise, surface_m)
    return Scan2D(cloud.stamp_s, angles, ranges, times, 0.0, range_max_m, "base_link")


@njit(cache=True)
def _nearest(
    points: Singles, stamps: Floats, low: float, high: float, rise: float, bins: int
) -> tuple[Floats, Singles, Floats]:
    width = 2.0 * np.pi / bins
    angles = np.linspace(-np.pi, np.pi - width, bins) + 0.5 * width
    ranges = np.full(bins, np.float32(np.nan), np.float32)
    times = np.zeros(bins)
    for i in range(points.shape[0]):
        x, y, z = np.float64(points[i, 0]), np.float64(points[i, 1]), np.float64(points[i, 2])
        angle = np.arctan2(y, x)
        k = min(int((angle + np.pi) / width), bins - 1)
        away = np.hypot(x, y)
        if low + rise * away <= z <= high:
            distance = np.float32(away)
            if not ranges[k] <= distance:  # NaN and inf too
                ranges[k] = distance
                angles[k] = angle
                times[k] = stamps[i]
        elif np.isnan(ranges[k]):
            ranges[k] = np.inf
            times[k] = stamps[i]
    return angles, ranges, times


@njit(cache=True)
def _averaged(
    points: Singles, nearest: Singles, low: float, high: float, rise: float, surface: float
) -> Singles:
    """The mean of the returns in each direction that are of the nearest one's surface."""
    bins = nearest.shape[0]
    sums, counts = np.zeros(bins), np.zeros(bins)
    width = 2.0 * np.pi / bins
    for i in range(points.shape[0]):
        x, y, z = np.float64(points[i, 0]), np.float64(points[i, 1]), np.float64(points[i, 2])
        away = np.hypot(x, y)
        if low + rise * away <= z <= high:
            k = min(int((np.arctan2(y, x) + np.pi) / width), bins - 1)
            if away <= nearest[k] + surface:
                sums[k] += away
                counts[k] += 1.0
    means = nearest.copy()
    for k in range(bins):
        if counts[k] > 0.0:
            means[k] = np.float32(sums[k] / counts[k])
    return means

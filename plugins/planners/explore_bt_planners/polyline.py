"""Polylines: (N, 2) float64, any unit of length."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import way_along

__all__ = ["length_of", "resample", "subdivide", "without_repeats"]


def length_of(polyline: NDArray[np.float64]) -> float:
    """Along the polyline."""
    return float(way_along(polyline)[-1])


@njit(cache=True)
def resample(polyline, spacing):  # type: ignore[no-untyped-def]  # numba kernel
    """Points evenly spaced along a polyline, about ``spacing`` apart, ends included: (M, 2) float64."""
    along = np.zeros(len(polyline))
    for i in range(1, len(polyline)):
        u, v = polyline[i] - polyline[i - 1]
        along[i] = along[i - 1] + math.hypot(u, v)
    count = max(1, round(along[-1] / spacing))
    points = np.empty((count + 1, 2))
    points[0], points[count] = polyline[0], polyline[-1]
    i = 0
    for k in range(1, count):
        wanted = along[-1] * k / count
        while along[i + 1] < wanted:
            i += 1
        share = (wanted - along[i]) / (along[i + 1] - along[i])
        points[k] = polyline[i] + (polyline[i + 1] - polyline[i]) * share
    return points


@njit(cache=True)
def subdivide(polyline, spacing):  # type: ignore[no-untyped-def]  # numba kernel
    """The polyline with all of its corners, no piece longer than ``spacing``: (M, 2) float64."""
    counts = np.empty(len(polyline) - 1, dtype=np.int64)
    for i in range(len(counts)):
        u, v = polyline[i + 1] - polyline[i]
        counts[i] = max(1, math.ceil(math.hypot(u, v) / spacing))
    points = np.empty((counts.sum() + 1, 2))
    points[0] = polyline[0]
    at = 1
    for i in range(len(counts)):
        for k in range(1, counts[i] + 1):
            points[at] = polyline[i] + (polyline[i + 1] - polyline[i]) * (k / counts[i])
            at += 1
    return points


def without_repeats(polyline: NDArray[np.float64]) -> NDArray[np.float64]:
    """The polyline without points that repeat the one before."""
    moved = np.hypot(*np.diff(polyline, axis=0).T) > 1e-9
    kept = polyline[np.concatenate(([True], moved))]
    kept[-1] = polyline[-1]
    return kept

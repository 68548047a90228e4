"""Rays against people: a post up to the shoulders, and a ball on it."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from explore_bt_drivers.mujoco.scene.build import HEAD_M, SHOULDERS_M
from explore_bt_drivers.people.ways import disc_at

__all__ = ["shorten"]


@njit(cache=True)
def shorten(ways, times, origins, directions, lengths):  # type: ignore[no-untyped-def]  # kernel
    """Shorten rays where people are in the way, each person where they are at the ray's own time.

    Args:
        ways: of the people, known at all times.
        times: (N,) float64, seconds.
        origins: (N, 3) float64, metres.
        directions: (N, 3) float64 unit vectors.
        lengths: (N,) float64, metres; is changed.

    Returns:
        (N,) bool: the rays that now end at a person.
    """
    shown = np.zeros(times.shape[0], dtype=np.bool_)
    last = math.nan
    places = np.empty((ways.radii.shape[0], 2))
    for i in range(times.shape[0]):
        if times[i] != last:
            last = times[i]
            for person in range(places.shape[0]):
                places[person, 0], places[person, 1], _, _ = disc_at(ways, person, last)
        for person in range(places.shape[0]):
            length = _to_person(
                origins[i],
                directions[i],
                places[person, 0],
                places[person, 1],
                ways.radii[person],
            )
            if length < lengths[i]:
                lengths[i] = length
                shown[i] = True
    return shown


@njit(cache=True)
def _to_person(origin, direction, x, y, radius):  # type: ignore[no-untyped-def]  # kernel
    """Distance to the first of side, shoulders and head that the ray meets from outside; inf if none."""
    ox, oy, oz = origin[0] - x, origin[1] - y, origin[2]
    dx, dy, dz = direction[0], direction[1], direction[2]
    best = math.inf
    a = dx * dx + dy * dy
    if a > 0.0:
        b, c = ox * dx + oy * dy, ox * ox + oy * oy - radius * radius
        root = b * b - a * c
        if root >= 0.0 and c > 0.0 and b < 0.0:
            t = c / (-b + math.sqrt(root))
            if 0.0 <= oz + t * dz <= SHOULDERS_M:
                best = t
    if dz < 0.0 and oz > SHOULDERS_M:
        t = (SHOULDERS_M - oz) / dz
        if math.hypot(ox + t * dx, oy + t * dy) <= radius:
            best = min(best, t)
    hz = oz - SHOULDERS_M - HEAD_M
    b, c = ox * dx + oy * dy + hz * dz, ox * ox + oy * oy + hz * hz - HEAD_M * HEAD_M
    root = b * b - c
    if root >= 0.0 and c > 0.0 and b < 0.0:
        best = min(best, c / (-b + math.sqrt(root)))
    return best

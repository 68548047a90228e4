"""A planar lidar about the base's centre, turning while the robot moves."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from explore_bt.types import Scan2D
from explore_bt_drivers.people import Crowd
from explore_bt_drivers.people.ways import Ways, disc_ahead, joined
from explore_bt_drivers.sim2d.body import Track
from explore_bt_drivers.sim2d.company import Company
from explore_bt_drivers.sim2d.motion import YAW, X, Y, place_at, value_at
from explore_bt_drivers.sim2d.options import Sim2dOptions
from explore_bt_drivers.world import World
from explore_bt_drivers.world.index import MIRROR, MOST_MIRRORS, first_hit, reflected

__all__ = ["Lidar"]

_RANGE_MIN_M = 0.02
_TAIL = 4.0
"""Noise can bring a return from beyond the range back into it: look that many sigmas further."""


class Lidar:
    """Sweeps of the world; beam i of N points to -π + 2πi/N and the last one is measured at the stamp.

    Attributes:
        world: what sweeps see that end from now on; may be exchanged for another version between two calls.
    """

    def __init__(
        self,
        world: World,
        options: Sim2dOptions,
        rng: np.random.Generator,
        dropout_rng: np.random.Generator,
        crowd: Crowd,
        company: Company,
    ) -> None:
        self.world = world
        self._crowd = crowd
        self._company = company
        self._rate_hz = options.lidar_rate
        self._range_m = options.lidar_range
        self._noise_m = options.range_noise if options.noise else 0.0
        self._dropout = options.dropout if options.noise else 0.0
        self._rng, self._dropout_rng = rng, dropout_rng
        count = options.beams
        self._angles = -math.pi + np.arange(count, dtype=np.float64) * (2.0 * math.pi / count)
        self._times = (np.arange(count, dtype=np.float64) + 1 - count) / (count * self._rate_hz)
        self._angles.flags.writeable = self._times.flags.writeable = False
        self._sweeps = 0

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._sweeps = track.due(self._rate_hz)

    def measure(self, track: Track) -> list[Scan2D]:
        """The sweeps finished since the last call."""
        finished = track.due(self._rate_hz)
        scans = [self._sweep(track, sweep / self._rate_hz) for sweep in range(self._sweeps + 1, finished + 1)]
        self._sweeps = finished
        return scans

    def _sweep(self, track: Track, stamp_s: float) -> Scan2D:
        ranges = np.empty(len(self._angles), dtype=np.float64)
        reach = self._range_m + _TAIL * self._noise_m
        index, states = self.world.index, track.states
        shown = _cast_sweep(
            index,
            self._ways(track, stamp_s, reach),
            states,
            track.first_step,
            stamp_s,
            self._times,
            self._angles,
            reach,
            ranges,
        )
        if self._noise_m > 0.0:
            ranges += self._rng.normal(0.0, self._noise_m, len(ranges))
        ranges[ranges > self._range_m] = math.inf
        # people and robots come nearer than walls do, even into the lidar
        ranges[shown & (ranges < _RANGE_MIN_M)] = math.nan
        if self._dropout > 0.0:
            ranges[self._dropout_rng.random(len(ranges)) < self._dropout] = math.nan
        measured = ranges.astype(np.float32)
        measured.flags.writeable = False
        return Scan2D(stamp_s, self._angles, measured, self._times, _RANGE_MIN_M, self._range_m)

    def _ways(self, track: Track, stamp_s: float, reach_m: float) -> Ways:
        """Of people and other robots during a sweep."""
        robots = self._company.ways(track, stamp_s + float(self._times[0]), stamp_s, reach_m)
        return self._crowd.ways if robots is None else joined(self._crowd.ways, robots)


@njit(cache=True)
def _cast_sweep(index, ways, states, first_step, stamp, times, angles, limit, out):  # type: ignore[no-untyped-def]  # kernel
    """Exact ranges of a sweep; robot and people are where they are at each beam's own time.

    Returns:
        (N,) bool: the beams that end at a person.
    """
    shown = np.zeros(angles.shape[0], dtype=np.bool_)
    alone = ways.radii.shape[0] == 0
    for i in range(angles.shape[0]):
        row, share = place_at(stamp + times[i], first_step, states.shape[0])
        x, y = value_at(states, row, share, X), value_at(states, row, share, Y)
        direction = value_at(states, row, share, YAW) + angles[i]
        dx, dy = math.cos(direction), math.sin(direction)
        wall, last = first_hit(index, x, y, dx, dy, limit)
        if alone and (last < 0 or index.materials[last] != MIRROR):
            out[i] = wall
        else:
            out[i], shown[i] = _beam(index, ways, stamp + times[i], x, y, dx, dy, limit)
    return shown


@njit(cache=True)
def _beam(index, ways, time, x, y, dx, dy, limit):  # type: ignore[no-untyped-def]  # kernel
    """Length of a beam by way of mirrors, and whether it ends at a person."""
    driven, last = 0.0, -1
    for _ in range(MOST_MIRRORS):
        wall, last = first_hit(index, x, y, dx, dy, limit - driven, last)
        person = disc_ahead(ways, time, x, y, dx, dy, limit - driven)
        if person < wall:
            return driven + person, True
        driven += wall
        if last < 0 or index.materials[last] != MIRROR:
            return driven, False
        x, y = x + wall * dx, y + wall * dy
        dx, dy = reflected(index.segments, last, dx, dy)
    return math.inf, False

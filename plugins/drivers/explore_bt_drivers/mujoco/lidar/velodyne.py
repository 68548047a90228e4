"""A lidar like the VLP-16: 16 rings, a column at a time, turning while the robot moves."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import PointCloud
from explore_bt_drivers.mujoco.lidar.caster import Caster, best_caster
from explore_bt_drivers.mujoco.lidar.posts import shorten
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.rotations import matrices
from explore_bt_drivers.mujoco.scene import Surroundings
from explore_bt_drivers.mujoco.scene.surface import Surface
from explore_bt_drivers.mujoco.scene.surroundings import Stands
from explore_bt_drivers.mujoco.track import Track
from explore_bt_drivers.world import Material

__all__ = ["RINGS", "VelodyneLike"]

RINGS = 16
_RANGE_MIN_M = 0.1
_TAIL = 4.0
"""Noise can bring a return from beyond the range back into it: look that many sigmas further."""

CasterMaker = Callable[[Sequence[Mapping[Material, Surface]]], Caster]


class VelodyneLike:
    """Sweeps of rings from -15° to 15°, column by column counter-clockwise from astern.

    Every column is cast from where the lidar is at its own time, tilted as it is then, at people and doors
    as they are then. A beam that meets nothing within range, or drops out, is a row of NaN: a point has no
    way to say "nothing there". Beams pass through glass and are reflected by mirrors.
    """

    def __init__(
        self,
        surroundings: Surroundings,
        options: MujocoOptions,
        rng: np.random.Generator,
        make_caster: CasterMaker = best_caster,
    ) -> None:
        """Build what rays are cast against.

        Args:
            surroundings: people and things; settled up to the time that is measured.
            options: rate, columns, range, noise, mount, what is covered.
            rng: noise.
            make_caster: from the surfaces of everything that stands at a time.
        """
        self._surroundings = surroundings
        self._rate_hz = options.lidar_rate
        self._range_m = options.lidar_range
        self._noise_m = options.range_noise if options.noise else 0.0
        self._dropout = options.dropout if options.noise else 0.0
        self._rng = rng
        self._make_caster = make_caster
        self._casters: dict[Stands, Caster] = {}
        self._mount = np.eye(4)
        self._mount[:3, 3] = options.lidar_mount
        self._beams, self._times = _pattern(options.columns, self._rate_hz)
        self._covered = _covered(options.columns, options.lidar_blocked)
        for array in (self._mount, self._times):
            array.flags.writeable = False
        self._sweeps = 0
        self._caster(surroundings.stands_at(0.0))

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._sweeps = track.due(self._rate_hz)

    def measure(self, track: Track) -> list[PointCloud]:
        """The sweeps finished since the last call."""
        finished = track.due(self._rate_hz)
        clouds = [
            self._sweep(track, sweep / self._rate_hz) for sweep in range(self._sweeps + 1, finished + 1)
        ]
        self._sweeps = finished
        return clouds

    def _sweep(self, track: Track, stamp_s: float) -> PointCloud:
        columns = len(self._times) // RINGS
        times = stamp_s + self._times[::RINGS]
        positions, quaternions = track.at(times)
        turns = matrices(quaternions)
        origins = positions + turns @ self._mount[:3, 3]
        directions = np.einsum("cij,crj->cri", turns, self._beams.reshape(columns, RINGS, 3)).reshape(-1, 3)
        ranges = self._cast(stamp_s, np.repeat(times, RINGS), np.repeat(origins, RINGS, axis=0), directions)
        if self._noise_m > 0.0:
            ranges += self._rng.normal(0.0, self._noise_m, len(ranges))
        is_lost = self._covered | ~((ranges >= _RANGE_MIN_M) & (ranges <= self._range_m))
        if self._dropout > 0.0:
            is_lost |= self._rng.random(len(ranges)) < self._dropout
        ranges[is_lost] = math.nan
        points = (self._beams * ranges[:, None]).astype(np.float32)
        points.flags.writeable = False
        return PointCloud(stamp_s, points, self._times, self._mount, range_max_m=self._range_m)

    def _cast(
        self,
        stamp_s: float,
        times: NDArray[np.float64],
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """(N,) exact ranges; the sweep is cut where a thing is moved during it."""
        cuts = [times[0], *self._surroundings.changes_between(times[0], stamp_s), math.inf]
        edges = np.searchsorted(times, cuts)
        ranges = np.empty(len(times))
        for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            if begin < end:
                part = slice(begin, end)
                caster = self._caster(self._surroundings.stands_at(times[begin]))
                ranges[part] = self._cast_at(caster, times[part], origins[part], directions[part])
        return ranges

    def _cast_at(
        self,
        caster: Caster,
        times: NDArray[np.float64],
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        ways = self._surroundings.ways
        ranges = np.zeros(len(times))
        is_over = np.zeros(len(times), dtype=np.bool_)
        for beams, begins, along, lengths in caster.legs(
            origins, directions, self._range_m + _TAIL * self._noise_m
        ):
            on = ~is_over[beams]
            lengths = lengths.copy()
            if len(ways.radii):
                is_over[beams] |= shorten(ways, times[beams], begins, along, lengths)
            ranges[beams[on]] += lengths[on]
        return ranges

    def _caster(self, stands: Stands) -> Caster:
        """Built once for each way in which things stand."""
        if stands not in self._casters:
            scene = self._surroundings.scene
            parts = [scene.fixed, *(thing[now] for thing, now in zip(scene.stands, stands, strict=True))]
            self._casters[stands] = self._make_caster(parts)
        return self._casters[stands]


def _pattern(columns: int, rate_hz: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) unit vectors in the lidar frame, column by column, and (N,) times before the last column."""
    azimuth = np.repeat(-math.pi + 2.0 * math.pi / columns * np.arange(columns), RINGS)
    up = np.tile(np.radians(np.linspace(-15.0, 15.0, RINGS)), columns)
    beams = np.column_stack((np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up)))
    times = (np.arange(columns) + 1 - columns) / (columns * rate_hz)
    return beams, np.repeat(times, RINGS)


def _covered(columns: int, share: float) -> NDArray[np.bool_]:
    """(N,) bool: the beams of those columns nearest to straight astern that something is in the way of."""
    from_astern = np.minimum(np.arange(columns), columns - np.arange(columns)) / columns
    return np.repeat(from_astern < 0.5 * share, RINGS)

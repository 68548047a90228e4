"""Things that move, found in scans: what stands now where there was free space.

A return is new if a scan of a moment ago saw through its place, or if it lies well inside the map's free
floor (free-space violation, as in Wolf & Sukhatme 2005): the first finds who crosses the view, the second who
comes into it from behind a corner. New returns that lie together are one thing, followed from scan to scan
with constant velocity; one that pauses is held for as long as returns come from its place.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration import clearance_at
from explore_bt.runtime.sight import Sight
from explore_bt.types import OCCUPIED, MovingObstacle, OccupancyGrid

__all__ = ["MovingThings"]

_LAGS_S = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.3)
"""How long ago places are asked for; a slow thing needs long to leave its own."""
_TOGETHER_M = 0.3
_FEWEST = 3
_WIDEST_M = 1.2
_SAME_M = 0.45
"""So far from where it is expected a thing is the same."""
_GAIN, _RATE_GAIN = 0.65, 0.3
"""Of the filter for place and velocity: how much of a surprise is believed at once."""
_HITS = 2
_FEW_HITS, _VELOCITY_OFF_MPS = 5, 0.5
"""Before so many hits nothing is known of a velocity, from then on it is right to so much."""
_SURELY_M = 0.6
"""Who has come so far is somebody: people are about."""
_MOVED_M, _LEAST_MPS = 0.15, 0.15
"""What came less far than this, or slower, may be the flicker of an edge, or a thin leg seen at last."""
_BESIDE_M = 1.0
"""What is new so near to somebody is another at once: people who meet look like one for a while."""
_HOLD_S = 5.0
"""What has paused for so long is left to the map."""
_LOST_S, _LOST_NEAR_S, _NEAR_M = 0.3, 1.0, 1.5
"""How long one that is out of sight is followed; longer beside the robot, where it may hide all the view."""
_ABOUT_S = 60.0
_OFF_M = 0.15
"""A return so far from everything that the map does not call free is no wall drawn a little thin."""
_LEAST_RADIUS_M = 0.15
_BLUR_M = 0.03
"""By which the front of what comes is seen too far off, for noise and for the time of a sweep."""
_STEP_M = 0.1


@dataclass(slots=True)
class _Thing:
    """What is followed."""

    number: int
    xy: NDArray[np.float64]
    velocity: NDArray[np.float64]
    radius_m: float
    stamp_s: float
    first_xy: NDArray[np.float64]
    first_s: float
    moved_s: float
    walks: bool
    floor: OccupancyGrid
    hits: int = 1
    has_moved: bool = False

    def predicted(self, stamp_s: float) -> NDArray[np.float64]:
        return self.xy + (stamp_s - self.stamp_s) * self.velocity

    def take(self, centre: NDArray[np.float64], radius_m: float, stamp_s: float) -> None:
        dt_s = max(stamp_s - self.stamp_s, 1e-3)
        surprise = centre - self.predicted(stamp_s)
        self.hits += 1
        gain, rate_gain = _gains(self.hits)
        self.xy = self.predicted(stamp_s) + gain * surprise
        self.velocity = self.velocity + rate_gain / dt_s * surprise
        self.radius_m = max(radius_m, 0.8 * self.radius_m)
        self.stamp_s = stamp_s
        moved_m = math.dist(centre, self.first_xy)
        self.has_moved |= moved_m > max(_MOVED_M, _LEAST_MPS * (stamp_s - self.first_s))

    def come_apart(self) -> None:
        """It is somebody who walked with another, or behind, and was taken for one with them."""
        self.walks, self.has_moved, self.hits = True, True, _HITS

    @property
    def is_sure(self) -> bool:
        return self.walks and self.has_moved and self.hits >= _HITS

    @property
    def velocity_off_mps(self) -> float:
        return _VELOCITY_OFF_MPS if self.hits >= _FEW_HITS else math.inf

    def as_obstacle(self) -> MovingObstacle:
        x, y = self.xy.tolist()
        vx, vy = self.velocity.tolist()
        return MovingObstacle(
            self.number, (x, y), (vx, vy), self.radius_m, self.stamp_s, self.velocity_off_mps
        )


class MovingThings:
    """Follows what moves around one robot, scan by scan."""

    def __init__(self) -> None:
        self._sights: deque[Sight] = deque()
        self._things: list[_Thing] = []
        self._count = 0
        self._last_seen_s = -math.inf

    def forget(self) -> None:
        """The scans seen so far no longer lie where the pose says: a loop closure moved it."""
        self._sights.clear()
        self._things.clear()

    def see(self, sight: Sight, grid: OccupancyGrid) -> tuple[MovingObstacle, ...]:
        """What moves, as far as this scan and those before it tell.

        Args:
            sight: the newest scan.
            grid: the map; what stands on its free floor was not there when it was drawn.
        """
        is_seen_through = self._was_seen_through(sight)
        is_new = np.flatnonzero(is_seen_through | _is_on_free_floor(sight.points, grid))
        self._follow([is_new[group] for group in _groups(sight.points[is_new])], is_seen_through, sight, grid)
        self._sights.append(sight)
        while self._sights[0].stamp_s < sight.stamp_s - _LAGS_S[-1]:
            self._sights.popleft()
        found = tuple(thing.as_obstacle() for thing in self._things if thing.is_sure)
        if any(thing.is_sure and math.dist(thing.xy, thing.first_xy) > _SURELY_M for thing in self._things):
            self._last_seen_s = sight.stamp_s
        return found

    def are_about(self, now_s: float) -> bool:
        """Whether anyone has been seen in the last minute."""
        return now_s - self._last_seen_s < _ABOUT_S

    def _was_seen_through(self, sight: Sight) -> NDArray[np.bool_]:
        new = np.zeros(len(sight.points), dtype=np.bool_)
        for lag_s in _LAGS_S:
            then_s = sight.stamp_s - lag_s
            old = min(self._sights, key=lambda old: abs(old.stamp_s - then_s), default=None)
            if old is not None and abs(old.stamp_s - then_s) < 0.5 * lag_s:
                new |= old.sees_through(sight.points)
        return new

    def _stands_beside_somebody(self, place: NDArray[np.float64], stamp_s: float) -> bool:
        return any(
            thing.is_sure and math.dist(thing.predicted(stamp_s), place) < _BESIDE_M for thing in self._things
        )

    def _follow(
        self,
        groups: list[NDArray[np.int64]],
        is_seen_through: NDArray[np.bool_],
        sight: Sight,
        grid: OccupancyGrid,
    ) -> None:
        stamp_s = sight.stamp_s
        left = list(self._things)
        for members in groups:
            group, walks = sight.points[members], int(is_seen_through[members].sum()) >= _FEWEST
            centre, radius_m = _disc(group, sight.origin)
            same = min(left, key=lambda thing: math.dist(thing.predicted(stamp_s), centre), default=None)
            if same is not None and math.dist(same.predicted(stamp_s), centre) <= _SAME_M:
                same.take(centre, radius_m, stamp_s)
                same.moved_s, same.floor = stamp_s, grid
                same.walks |= walks
                left.remove(same)
            else:
                self._count += 1
                self._things.append(
                    _Thing(
                        self._count,
                        centre,
                        np.zeros(2),
                        radius_m,
                        stamp_s,
                        centre,
                        stamp_s,
                        stamp_s,
                        walks,
                        grid,
                    )
                )
                if self._stands_beside_somebody(centre, stamp_s):
                    self._things[-1].come_apart()
        for thing in left:
            _hold(thing, sight)
        self._things = [
            thing
            for thing in self._things
            if stamp_s - thing.stamp_s <= _followed_s(thing, sight) and stamp_s - thing.moved_s <= _HOLD_S
        ]


def _disc(group: NDArray[np.float64], seen_from: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Centre and radius of a body of which only the near side is seen: its front is where the returns are."""
    middle = group.mean(axis=0)
    radius_m = max(float(np.hypot(*(group - middle).T).max()), _LEAST_RADIUS_M)
    along = (middle - seen_from) / max(math.dist(middle, seen_from), 1e-6)
    front_m = float(((middle - group) @ along).max())
    return middle + max(radius_m - front_m - _BLUR_M, 0.0) * along, radius_m


def _gains(hits: int) -> tuple[float, float]:
    """Of place and velocity: while hits are few, those of the line of least squares through them all."""
    return (
        max(_GAIN, 2.0 * (2 * hits - 1) / (hits * (hits + 1))),
        max(_RATE_GAIN, 6.0 / (hits * (hits + 1))),
    )


def _followed_s(thing: _Thing, sight: Sight) -> float:
    if thing.hits < _HITS:
        return 0.0
    is_near = math.dist(thing.predicted(sight.stamp_s), sight.origin.tolist()) < _NEAR_M
    return _LOST_NEAR_S if is_near else _LOST_S


def _hold(thing: _Thing, sight: Sight) -> None:
    """It gave no new returns: it pauses where it still gives any, else it is out of sight."""
    if not thing.is_sure or not len(sight.points):
        return
    expected = thing.predicted(sight.stamp_s)
    near = sight.points[np.hypot(*(sight.points - expected).T) <= thing.radius_m + _STEP_M]
    near = near[~_is_drawn(near, thing.floor)]
    if len(near) >= _FEWEST:
        thing.take(_disc(near, sight.origin)[0], thing.radius_m, sight.stamp_s)  # a wall must not widen it


def _is_on_free_floor(points: NDArray[np.float64], grid: OccupancyGrid) -> NDArray[np.bool_]:
    if not len(points):
        return np.zeros(0, dtype=np.bool_)
    return np.asarray(clearance_at(grid, points, 2.0 * _OFF_M) > _OFF_M)


def _is_drawn(points: NDArray[np.float64], floor: OccupancyGrid) -> NDArray[np.bool_]:
    """(N,) bool: whether points lie at what a map calls occupied, give or take ``_OFF_M``."""
    reach = round(_OFF_M / floor.resolution_m)
    around = np.stack(np.meshgrid(*2 * [np.arange(-reach, reach + 1)]), axis=-1).reshape(-1, 2)
    at = floor.cells_of(points)[:, None] + around
    inside = np.all((at >= 0) & (at < floor.shape), axis=-1)
    rows, cols = np.where(inside[..., None], at, 0).transpose(2, 0, 1)
    return np.asarray((inside & (floor.cells[rows, cols] == OCCUPIED)).any(axis=1))


def _groups(points: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """Points chained by less than ``_TOGETHER_M``; scraps and what is too wide for one thing are left out."""
    left = list(range(len(points)))
    found = []
    while left:
        members, edge = [], [left.pop(0)]
        while edge:
            at = edge.pop()
            members.append(at)
            near = [k for k in left if math.dist(points[k], points[at]) < _TOGETHER_M]
            left = [k for k in left if k not in near]
            edge += near
        if len(members) >= _FEWEST and np.hypot(*np.ptp(points[members], axis=0)) <= _WIDEST_M:
            found.append(np.array(members))
    return found

"""Things that move, found in scans: what stands now where an earlier scan saw free space.

No map is asked: it draws a thing that pauses and keeps a trail of one that walks. A return is new if a scan
of a moment ago saw through its place (free-space violation, as in Wolf & Sukhatme 2005). New returns that
lie together are one thing, followed from scan to scan with constant velocity; one that pauses is held for as
long as returns come from its place.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MovingObstacle, Pose2, Scan2D, Twist2

__all__ = ["MovingThings"]

REACH_M = 5.0
_LAGS_S = (0.3, 0.5, 0.7, 1.0, 1.3)
"""How long ago places are asked for; a slow thing needs long to leave its own."""
_THROUGH_M, _THROUGH_SHARE = 0.2, 0.03
"""By how much (and for every metre away) a beam must have gone on behind a place to have seen through it."""
_TOGETHER_M = 0.3
_FEWEST = 3
_WIDEST_M = 1.2
_SAME_M = 0.45
"""So far from where it is expected a thing is the same."""
_GAIN, _RATE_GAIN = 0.5, 0.2
"""Of the filter for place and velocity: half of a surprise is believed at once."""
_HITS, _SURE_HITS = 2, 5
_MOVED_M = 0.25
"""What came less far than this, and in fewer scans, may be the flicker of an edge."""
_HOLD_S = 5.0
"""What has paused for so long is left to the map."""
_LOST_S = 0.5
_LEAST_RADIUS_M = 0.15


@dataclass(frozen=True, slots=True, eq=False)
class _Sight:
    """One scan as seen from where it was taken; ``map`` frame.

    Attributes:
        origin: (2,) metres, of the beams' middle.
        bearings: (N,) radians, ascending from the first one's.
        free_m: (N,) how far each beam went; 0 where it tells nothing.
        points: (M, 2) metres, the returns within ``REACH_M``, each taken from its own beam's place.
    """

    stamp_s: float
    origin: NDArray[np.float64]
    bearings: NDArray[np.float64]
    free_m: NDArray[np.float64]
    points: NDArray[np.float64]

    def sees_through(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(K,) bool: whether the beams at and beside (K, 2) places went on behind them."""
        off = places - self.origin
        away_m = np.hypot(off[:, 0], off[:, 1])
        first = self.bearings[0]
        bearing = first + np.mod(np.arctan2(off[:, 1], off[:, 0]) - first, 2.0 * math.pi)
        count = len(self.bearings)
        right = np.searchsorted(self.bearings, bearing)
        beside = (right[:, None] + np.array([-2, -1, 0, 1])) % count
        beyond_m = self.free_m[beside].min(axis=1)
        gap = np.abs(_wrapped(self.bearings[beside[:, 1:3]] - bearing[:, None])).max(axis=1)
        is_looked_at = gap < 4.0 * (self.bearings[-1] - first) / max(count - 1, 1)
        return np.asarray(is_looked_at & (beyond_m > away_m * (1.0 + _THROUGH_SHARE) + _THROUGH_M))


@dataclass(slots=True)
class _Thing:
    """What is followed."""

    number: int
    xy: NDArray[np.float64]
    velocity: NDArray[np.float64]
    radius_m: float
    stamp_s: float
    first_xy: NDArray[np.float64]
    moved_s: float
    hits: int = 1
    has_moved: bool = False

    def predicted(self, stamp_s: float) -> NDArray[np.float64]:
        return self.xy + (stamp_s - self.stamp_s) * self.velocity

    def take(self, centre: NDArray[np.float64], radius_m: float, stamp_s: float) -> None:
        dt_s = max(stamp_s - self.stamp_s, 1e-3)
        surprise = centre - self.predicted(stamp_s)
        self.xy = self.predicted(stamp_s) + _GAIN * surprise
        self.velocity = self.velocity + _RATE_GAIN / dt_s * surprise
        self.radius_m = max(radius_m, 0.8 * self.radius_m)
        self.stamp_s = stamp_s
        self.hits += 1
        self.has_moved |= self.hits >= _SURE_HITS or math.dist(self.xy, self.first_xy) > _MOVED_M

    def as_obstacle(self) -> MovingObstacle:
        x, y = self.xy.tolist()
        vx, vy = self.velocity.tolist()
        return MovingObstacle(self.number, (x, y), (vx, vy), self.radius_m, self.stamp_s)


class MovingThings:
    """Follows what moves around one robot, scan by scan."""

    def __init__(self) -> None:
        self._sights: deque[_Sight] = deque()
        self._things: list[_Thing] = []
        self._count = 0

    def forget(self) -> None:
        """The scans seen so far no longer lie where the pose says: a loop closure moved it."""
        self._sights.clear()
        self._things.clear()

    def see(self, scan: Scan2D, pose: Pose2, twist: Twist2) -> tuple[MovingObstacle, ...]:
        """What moves, as far as this scan and those before it tell.

        Args:
            scan: the newest.
            pose: of the robot at the scan's stamp, ``map`` frame.
            twist: of the robot during the scan; its beams are put where they were measured.
        """
        sight = _sight_of(scan, pose, twist)
        if sight is None:
            return ()
        groups = _groups(sight.points[self._is_new(sight)])
        self._follow(groups, sight)
        self._sights.append(sight)
        while self._sights[0].stamp_s < sight.stamp_s - _LAGS_S[-1]:
            self._sights.popleft()
        return tuple(thing.as_obstacle() for thing in self._things if thing.has_moved and thing.hits >= _HITS)

    def _is_new(self, sight: _Sight) -> NDArray[np.bool_]:
        new = np.zeros(len(sight.points), dtype=np.bool_)
        for lag_s in _LAGS_S:
            then_s = sight.stamp_s - lag_s
            old = min(self._sights, key=lambda old: abs(old.stamp_s - then_s), default=None)
            if old is not None and abs(old.stamp_s - then_s) < 0.5 * lag_s:
                new |= old.sees_through(sight.points)
        return new

    def _follow(self, groups: list[NDArray[np.float64]], sight: _Sight) -> None:
        stamp_s = sight.stamp_s
        left = list(self._things)
        for group in groups:
            centre = group.mean(axis=0)
            radius_m = max(float(np.hypot(*(group - centre).T).max()), _LEAST_RADIUS_M)
            same = min(left, key=lambda thing: math.dist(thing.predicted(stamp_s), centre), default=None)
            if same is not None and math.dist(same.predicted(stamp_s), centre) <= _SAME_M:
                same.take(centre, radius_m, stamp_s)
                same.moved_s = stamp_s
                left.remove(same)
            else:
                self._count += 1
                still = np.zeros(2)
                self._things.append(_Thing(self._count, centre, still, radius_m, stamp_s, centre, stamp_s))
        for thing in left:
            _hold(thing, sight)
        self._things = [
            thing
            for thing in self._things
            if stamp_s - thing.stamp_s <= (_LOST_S if thing.hits >= _HITS else 0.0)
            and stamp_s - thing.moved_s <= _HOLD_S
        ]


def _hold(thing: _Thing, sight: _Sight) -> None:
    """It gave no new returns: it pauses where it still gives any, else it is out of sight."""
    if not thing.has_moved or not len(sight.points):
        return
    expected = thing.predicted(sight.stamp_s)
    near = sight.points[np.hypot(*(sight.points - expected).T) <= thing.radius_m + 0.1]
    if len(near) >= _FEWEST:
        centre = near.mean(axis=0)
        thing.take(centre, float(np.hypot(*(near - centre).T).max()), sight.stamp_s)


def _sight_of(scan: Scan2D, pose: Pose2, twist: Twist2) -> _Sight | None:
    told = ~np.isnan(scan.ranges_m) & (scan.ranges_m >= scan.range_min_m)
    if np.count_nonzero(told) < _FEWEST:
        return None
    times_s = scan.times_s
    sensor = scan.T_base_sensor
    yaws = pose.yaw_rad + twist.angular_rps * times_s
    middle = pose.yaw_rad + 0.5 * twist.angular_rps * times_s
    origins = np.column_stack(
        (
            pose.x
            + twist.linear_mps * times_s * np.cos(middle)
            + sensor.x * np.cos(yaws)
            - sensor.y * np.sin(yaws),
            pose.y
            + twist.linear_mps * times_s * np.sin(middle)
            + sensor.x * np.sin(yaws)
            + sensor.y * np.cos(yaws),
        )
    )
    bearings = yaws + sensor.yaw_rad + scan.angles_rad
    ranges = np.where(told, np.minimum(scan.ranges_m, scan.range_max_m), 0.0).astype(np.float64)
    hit = scan.is_return & (scan.ranges_m <= REACH_M)
    along = np.column_stack((np.cos(bearings[hit]), np.sin(bearings[hit])))
    points = origins[hit] + ranges[hit][:, None] * along
    order = np.argsort(bearings)
    return _Sight(scan.stamp_s, origins.mean(axis=0), bearings[order], ranges[order], points)


def _groups(points: NDArray[np.float64]) -> list[NDArray[np.float64]]:
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
        group = points[members]
        if len(group) >= _FEWEST and np.hypot(*np.ptp(group, axis=0)) <= _WIDEST_M:
            found.append(group)
    return found


def _wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((angles + math.pi) % (2.0 * math.pi) - math.pi)

"""A robot of a trial: a disc that drives along polylines, looks about, and is watched by the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration import CoverageMeter
from explore_bt.types import OccupancyGrid, Pose2, wrap_angle

__all__ = ["MapDrawer", "TrialRobot", "TrialSettings", "TrueWorld"]

_TOUCH_M = 1e-6
_CHECK_M = 0.02
_SAME_PLACE_M = 1e-3


class TrueWorld(Protocol):
    """The geometry, exact; ``explore_bt_drivers.world.World`` is one."""

    def cast(
        self, x: float, y: float, angles_rad: NDArray[np.float64], limit_m: float
    ) -> NDArray[np.float64]:
        """(N,) float64 ranges along (N,) directions in the world; +inf beyond the limit."""

    def clearance_m(self, x: float, y: float) -> float:
        """Metres from a point to the nearest solid."""


class MapDrawer(Protocol):
    """What makes an occupancy grid of scans taken at known poses."""

    def see(self, pose: Pose2, angles_rad: NDArray[np.float64], ranges_m: NDArray[np.float64]) -> None:
        """Take in a scan: (N,) directions in ``map``, (N,) ranges, +inf for no return."""

    def grid(self) -> OccupancyGrid:
        """The map so far, in the frame of the world."""


@dataclass(frozen=True, slots=True)
class TrialSettings:
    """What robot drives, and how it is asked.

    Attributes:
        beams: of one scan, evenly all round, without noise.
        step_m: a scan is taken after every so many metres.
        decide_every_m: metres after which the explorer is asked again, whatever it said.
        turn_rate_rps: turning takes at least this long, driving at least length over speed.
        most_path_m: the trial ends there.
    """

    radius_m: float = 0.2
    range_m: float = 5.0
    beams: int = 360
    step_m: float = 0.1
    decide_every_m: float = 0.5
    speed_mps: float = 0.5
    turn_rate_rps: float = 1.0
    most_path_m: float = math.inf


class TrialRobot:
    """Stands at ``pose`` and knows what it has done so far."""

    def __init__(
        self,
        world: TrueWorld,
        drawer: MapDrawer,
        floor: OccupancyGrid,
        start: Pose2,
        settings: TrialSettings,
    ) -> None:
        """Looks about at the start.

        Args:
            world: the truth.
            drawer: what the explorer's map comes from.
            floor: its ``FREE`` cells are what coverage is the share of.
            start: pose in the frame of the world and of the map.
            settings: the robot.

        Raises:
            WorldError: the floor has no free cell.
        """
        self._world = world
        self._drawer = drawer
        self._meter = CoverageMeter(floor)
        self._settings = settings
        self._angles: NDArray[np.float64] = (
            2.0 * math.pi / settings.beams * np.arange(settings.beams, dtype=np.float64)
        )
        self._clearance_integral = 0.0
        self._curve: list[tuple[float, float, float]] = []
        self._track: list[tuple[float, float, float]] = []
        self.pose = start
        self.path_m = self.time_s = self.turning_rad = 0.0
        self.contacts = 0
        self.min_clearance_m = world.clearance_m(start.x, start.y)
        self._look()

    @property
    def grid(self) -> OccupancyGrid:
        """The map so far."""
        return self._drawer.grid()

    @property
    def coverage(self) -> float:
        """The share of the floor that the map knows."""
        return self._curve[-1][2]

    @property
    def mean_clearance_m(self) -> float:
        """Exact distance from the centre to the nearest solid, averaged over the way."""
        return self._clearance_integral / self.path_m if self.path_m > 0.0 else self.min_clearance_m

    @property
    def curve(self) -> NDArray[np.float64]:
        """(N, 3) float64, one row a scan: metres driven, seconds, coverage."""
        return np.array(self._curve)

    @property
    def track(self) -> NDArray[np.float64]:
        """(N, 3) float64, one row a scan: x, y in metres, yaw in radians."""
        return np.array(self._track)

    def turn_to(self, yaw_rad: float) -> None:
        """Turn in place; a lidar that sees all round learns nothing from it."""
        turn_rad = abs(wrap_angle(yaw_rad - self.pose.yaw_rad))
        self.turning_rad += turn_rad
        self.time_s += turn_rad / self._settings.turn_rate_rps
        self.pose = Pose2(*self.pose.xy, wrap_angle(yaw_rad))

    def drive(self, way: list[tuple[float, float]], most_m: float) -> bool:
        """Drive along the vertices of a polyline, removing those passed; look about at the end.

        Args:
            way: what is left of the polyline; the robot drives straight to its first vertex.
            most_m: metres to drive.

        Returns:
            False if the footprint would touch something; then the robot stands before it.
        """
        went_well = True
        while went_well and way and most_m > _SAME_PLACE_M:
            to_go = math.dist(self.pose.xy, way[0])
            if to_go < _SAME_PLACE_M:
                way.pop(0)
                continue
            length_m = min(to_go, most_m)
            went_well = self._straight(way[0], length_m)
            most_m -= length_m
        self._look()
        return went_well

    def _straight(self, to: tuple[float, float], length_m: float) -> bool:
        x, y = self.pose.xy
        self._take_heading(math.atan2(to[1] - y, to[0] - x), length_m)
        cos, sin = math.cos(self.pose.yaw_rad), math.sin(self.pose.yaw_rad)
        count = math.ceil(length_m / _CHECK_M)
        for _ in range(count):
            piece_m = length_m / count
            there = Pose2(self.pose.x + cos * piece_m, self.pose.y + sin * piece_m, self.pose.yaw_rad)
            clearance_m = self._world.clearance_m(*there.xy)
            if clearance_m < self._settings.radius_m - _TOUCH_M:
                self.contacts += 1
                return False
            self.pose = there
            self.path_m += piece_m
            self._clearance_integral += clearance_m * piece_m
            self.min_clearance_m = min(self.min_clearance_m, clearance_m)
        return True

    def _take_heading(self, yaw_rad: float, length_m: float) -> None:
        """A stretch lasts as long as its length or the turn before it asks, whichever is longer."""
        turn_rad = abs(wrap_angle(yaw_rad - self.pose.yaw_rad))
        self.turning_rad += turn_rad
        self.time_s += max(length_m / self._settings.speed_mps, turn_rad / self._settings.turn_rate_rps)
        self.pose = Pose2(*self.pose.xy, yaw_rad)

    def _look(self) -> None:
        ranges_m = self._world.cast(*self.pose.xy, self._angles, self._settings.range_m)
        self._drawer.see(self.pose, self._angles, ranges_m)
        coverage = self._meter.measure_around(self._drawer.grid(), self.pose.xy, self._settings.range_m + 0.1)
        self._curve.append((self.path_m, self.time_s, coverage))
        self._track.append((self.pose.x, self.pose.y, self.pose.yaw_rad))

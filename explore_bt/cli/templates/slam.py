"""A small SLAM: wheels for the guess, point-to-line scan matching for the pose, a grid for the map.

It closes no loops, so it drifts on long ways; that is where your own work begins.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.spatial import KDTree

from explore_bt import hookimpl
from explore_bt.errors import UserError
from explore_bt.interfaces import API_VERSION, PluginOptions, RobotContext, Slam
from explore_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Estimate,
    GridWindow,
    Health,
    Measurement,
    OccupancyGrid,
    Pose2,
    Scan2D,
    Trajectory,
    WheelOdometry,
    wrap_angle,
)
from explore_bt.units import Duration, Length

Points = NDArray[np.float64]

_FILE = "my_plugin.npz"
_COVARIANCE = np.diag([4e-4, 4e-4, 1e-4])
_ENOUGH = 30


class MyPlugin(Slam):
    """Matches each scan to the walls seen so far; the wheels say where to begin."""

    name = "my_plugin"
    api_version = API_VERSION

    class Options(PluginOptions):
        """What a mission may set: ``slam: {use: my_plugin, resolution: 5 cm}``."""

        resolution: Length = Field(0.05, gt=0.0, description="edge of a cell")
        size: Length = Field(40.0, gt=0.0, description="edge of the map, the start in its middle")
        keyframe: Length = Field(0.2, gt=0.0, description="new walls are taken in after so much way")
        silence: Duration = Field(1.0, gt=0.0, description="lost after so long without a good scan")

    options: Options

    def setup(self, context: RobotContext) -> None:
        """Begin with an empty map around the start."""
        self._pose = context.start or Pose2.identity()
        self._canvas = _Canvas(self._pose, self.options.size, self.options.resolution)
        self._walls = _Walls(np.zeros((0, 2)))
        self._wheels: deque[WheelOdometry] = deque(maxlen=40)
        self._stamp_s = 0.0
        self._good_s: float | None = None
        self._keyframe: Pose2 | None = None
        self._trouble = ""
        self._stamps_s: list[float] = []
        self._poses: list[Points] = []
        self._ms: list[float] = []
        self._keyframes = 0

    def update(self, measurement: Measurement) -> None:
        """The wheels carry the pose on, a scan corrects it; any other kind only tells the time."""
        if not math.isfinite(measurement.stamp_s) or measurement.stamp_s < self._stamp_s:
            self._trouble = f"a {type(measurement).__name__} came out of order"
            return
        self._stamp_s = measurement.stamp_s
        if self._good_s is None:
            self._good_s = self._stamp_s
        if isinstance(measurement, WheelOdometry):
            self._roll(measurement)
        elif isinstance(measurement, Scan2D):
            self._see(measurement)

    def estimate(self) -> Estimate:
        """The matched pose, carried on by the wheels."""
        silent_s = self._stamp_s - (self._good_s or 0.0)
        health, reason = (Health.DEGRADED if self._trouble else Health.OK), self._trouble
        if silent_s > self.options.silence:
            health, reason = Health.LOST, self._trouble or f"no scan for {silent_s:.1f} s"
        return Estimate(self._stamp_s, self._pose, _COVARIANCE, self.grid().revision, health, reason)

    def grid(self) -> OccupancyGrid:
        """The map so far."""
        return self._canvas.grid

    def changed_since(self, revision: int) -> GridWindow | None:
        """The box around all cells drawn since then."""
        return self._canvas.changed_since(revision)

    def trajectory(self) -> Trajectory:
        """One pose per good scan; without loop closures the past stays as it was believed."""
        return Trajectory(np.array(self._stamps_s), np.array(self._poses).reshape(-1, 3))

    def figures(self) -> Mapping[str, float]:
        """For the report."""
        median_ms = float(np.median(self._ms)) if self._ms else 0.0
        return {"keyframes": self._keyframes, "loop_closures": 0, "ms_per_scan_median": median_ms}

    def save(self, folder: Path) -> None:
        """The map, the walls, the way."""
        np.savez_compressed(
            folder / _FILE,
            cells=self.grid().cells,
            origin_xy=self.grid().origin_xy,
            resolution_m=self.grid().resolution_m,
            walls=self._walls.points,
            pose=self._pose.as_array(),
            stamps_s=self._stamps_s,
            poses=self.trajectory().poses,
        )

    def load(self, folder: Path) -> None:
        """Go on in a saved map, from the pose at which it was saved."""
        if not (folder / _FILE).is_file():
            raise UserError(f"{folder} holds no map of my_plugin; expected {_FILE}")
        with np.load(folder / _FILE) as saved:
            if float(saved["resolution_m"]) != self.options.resolution:
                raise UserError(
                    f"{folder / _FILE} has cells of {saved['resolution_m']} m; set resolution to it"
                )
            self._canvas.restore(saved["cells"], (float(saved["origin_xy"][0]), float(saved["origin_xy"][1])))
            self._walls = _Walls(saved["walls"])
            self._pose = Pose2(*(float(value) for value in saved["pose"]))
            self._stamps_s, self._poses = saved["stamps_s"].tolist(), list(saved["poses"])

    def _roll(self, odometry: WheelOdometry) -> None:
        if not np.isfinite(odometry.T_odom_base.as_array()).all():
            self._trouble = "wheel odometry is not finite"
            return
        if self._wheels:
            self._pose = self._pose.compose(self._wheels[-1].T_odom_base.between(odometry.T_odom_base))
        self._wheels.append(odometry)

    def _see(self, scan: Scan2D) -> None:
        began_s = time.perf_counter()  # a figure for the report, never an input
        beams = self._beams(scan)
        if not len(beams.ends):
            self._trouble = "the scan tells nothing: every beam is invalid"
            return
        self._trouble = ""
        self._good_s = scan.stamp_s
        returns = beams.ends[beams.hit]
        self._pose = self._walls.match(returns, self._pose)
        if self._keyframe is None or _moved(self._keyframe, self._pose) > self.options.keyframe:
            self._walls = self._walls.with_more(self._pose.apply(returns))
            self._keyframe = self._pose
            self._keyframes += 1
        in_map = replace(beams, ends=self._pose.apply(beams.ends))
        self._canvas.draw(self._pose.compose(scan.T_base_sensor).xy, in_map)
        self._stamps_s.append(scan.stamp_s)
        self._poses.append(self._pose.as_array())
        self._ms.append(1e3 * (time.perf_counter() - began_s))

    def _beams(self, scan: Scan2D) -> _Beams:
        """The valid beams in the base frame at the scan's stamp."""
        nothing = np.isposinf(scan.ranges_m)
        valid = scan.is_return | nothing
        ranges = np.where(nothing, scan.range_max_m, scan.ranges_m)[valid].astype(np.float64)
        angles = scan.angles_rad[valid]
        ends = np.column_stack((ranges * np.cos(angles), ranges * np.sin(angles)))
        ends = self._deskewed(scan.T_base_sensor.apply(ends), scan.times_s[valid])
        return _Beams(ends, scan.is_return[valid], np.diff(np.flatnonzero(valid)) == 1)

    def _deskewed(self, points: Points, times_s: Points) -> Points:
        """Each point as seen from where the robot is at the end of the sweep, by the wheels."""
        if len(self._wheels) < 2 or not len(points):
            return points
        stamps_s = np.array([each.stamp_s for each in self._wheels]) - self._stamp_s
        track = np.array([each.T_odom_base.as_array() for each in self._wheels])
        track[:, 2] = np.unwrap(track[:, 2])
        x, y, yaw = (np.interp(times_s, stamps_s, track[:, k]) for k in range(3))
        cos, sin = np.cos(yaw), np.sin(yaw)
        in_odom = np.column_stack(
            (x + cos * points[:, 0] - sin * points[:, 1], y + sin * points[:, 0] + cos * points[:, 1])
        )
        return self._wheels[-1].T_odom_base.inverse().apply(in_odom)


@dataclass(frozen=True)
class _Beams:
    """The valid beams of a scan.

    Attributes:
        ends: (N, 2) float64, metres; the sensor's range where there was no return.
        hit: (N,) bool: those that are returns.
        pairs: (N - 1,) bool: where a beam and the next valid one are neighbours in the scan.
    """

    ends: Points
    hit: NDArray[np.bool_]
    pairs: NDArray[np.bool_]


class _Walls:
    """Points on walls with their normals, ``map`` frame; a scan is moved until it lies on them."""

    def __init__(self, points: Points) -> None:
        self.points = points
        self._can_match = len(points) >= _ENOUGH
        if self._can_match:
            self._tree = KDTree(points)
            self._normals = self._fit_normals()

    def with_more(self, points: Points) -> _Walls:
        """These and the new ones that lie where nothing was yet."""
        if self._can_match:
            points = points[self._tree.query(points)[0] > 0.03]
        return _Walls(np.concatenate((self.points, points)))

    def match(self, scan: Points, guess: Pose2) -> Pose2:
        """The pose at which (N, 2) points of the base frame lie on the walls.

        Point-to-line registration by Gauss-Newton with Cauchy weights.
        """
        pose = guess
        for _ in range(20):
            if not self._can_match or not len(scan):
                return guess
            there = pose.apply(scan)
            distance, nearest = map(np.asarray, self._tree.query(there, distance_upper_bound=0.3))
            near = np.isfinite(distance)
            if near.sum() < _ENOUGH:
                return guess
            normals = self._normals[nearest[near]]
            residuals = ((there[near] - self.points[nearest[near]]) * normals).sum(axis=1)
            arms = there[near] - np.array(pose.xy)
            slopes = np.column_stack((normals, normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]))
            weights = 1.0 / (1.0 + (residuals / 0.05) ** 2)
            # a little damping: along a bare corridor the wheels decide
            hessian = slopes.T @ (slopes * weights[:, None]) + 0.1 * np.eye(3)
            step = np.linalg.solve(hessian, -slopes.T @ (weights * residuals))
            pose = Pose2(pose.x + step[0], pose.y + step[1], wrap_angle(pose.yaw_rad + step[2]))
            if np.abs(step).max() < 1e-5:
                break
        return Pose2(float(pose.x), float(pose.y), float(pose.yaw_rad))

    def _fit_normals(self) -> Points:
        """Across the main direction of each point and its five neighbours."""
        around = self.points[self._tree.query(self.points, k=6)[1]]
        away = around - around.mean(axis=1, keepdims=True)
        xx, yy, xy = ((away[:, :, a] * away[:, :, b]).sum(axis=1) for a, b in ((0, 0), (1, 1), (0, 1)))
        along = 0.5 * np.arctan2(2.0 * xy, xx - yy)
        return np.column_stack((-np.sin(along), np.cos(along)))


class _Canvas:
    """The grid of fixed size that scans are drawn into; grids handed out are never touched again."""

    def __init__(self, start: Pose2, size_m: float, resolution_m: float) -> None:
        side = math.ceil(size_m / resolution_m)
        # on a multiple of the resolution, so that maps of several runs fit together
        origin = [(math.floor(xy / resolution_m) - side // 2) * resolution_m for xy in start.xy]
        cells = np.full((side, side), UNKNOWN, dtype=np.int8)
        self.grid = OccupancyGrid(cells, resolution_m, (origin[0], origin[1]))
        self._changes: dict[int, GridWindow] = {}

    def draw(self, eye_xy: tuple[float, float], beams: _Beams) -> None:
        """Free from the eye (x, y) along and between the beams, occupied where they ended in a return."""
        eye, ways = np.array(eye_xy), beams.ends - np.array(eye_xy)
        lengths = np.maximum(np.hypot(ways[:, 0], ways[:, 1]), 1e-6)
        reach = np.maximum(lengths - np.where(beams.hit, self.grid.resolution_m, 0.0), 0.0)
        ways /= lengths[:, None]
        common = np.minimum(reach[:-1], reach[1:])[beams.pairs][:, None]
        seen = np.zeros(self.grid.shape, dtype=np.uint8)
        cv2.polylines(seen, self._shapes(eye, eye + ways * reach[:, None]), isClosed=False, color=1)
        wedges = self._shapes(
            eye, eye + ways[:-1][beams.pairs] * common, eye + ways[1:][beams.pairs] * common
        )
        cv2.fillPoly(seen, wedges, color=1)
        cells = self.grid.cells.copy()
        # a wall once seen stays: beams that graze it would wipe it out
        cells[(seen == 1) & (cells != OCCUPIED)] = FREE
        walls = self._inside(beams.ends[beams.hit])
        cells[walls[:, 0], walls[:, 1]] = OCCUPIED
        self._publish(cells)

    def changed_since(self, revision: int) -> GridWindow | None:
        """The box around what changed after a revision; None for one from before a restored map."""
        if revision == self.grid.revision:
            return GridWindow(0, 0, 0, 0)
        since = [self._changes.get(each) for each in range(revision + 1, self.grid.revision + 1)]
        known = [each for each in since if each is not None]
        if len(known) < len(since) or not known:
            return None
        return GridWindow(
            min(each.row0 for each in known),
            min(each.col0 for each in known),
            max(each.row1 for each in known),
            max(each.col1 for each in known),
        )

    def restore(self, cells: NDArray[np.int8], origin_xy: tuple[float, float]) -> None:
        """Take over a saved map."""
        self.grid = OccupancyGrid(cells, self.grid.resolution_m, origin_xy, self.grid.revision + 1)
        self._changes.clear()

    def _shapes(self, eye: Points, *corners: Points) -> list[NDArray[np.int32]]:
        """What OpenCV draws: per row of the (N, 2) corners, columns and rows of the eye and of those."""
        cells = [np.broadcast_to(self.grid.cells_of(eye[None, :]), corners[0].shape)]
        cells += [self.grid.cells_of(each) for each in corners]
        return list(np.stack(cells, axis=1)[:, :, ::-1].astype(np.int32))

    def _inside(self, points: Points) -> NDArray[np.int64]:
        cells = self.grid.cells_of(points)
        return cells[((cells >= 0) & (cells < np.asarray(self.grid.shape))).all(axis=1)]

    def _publish(self, cells: NDArray[np.int8]) -> None:
        changed = cells != self.grid.cells
        rows, cols = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
        if not len(rows):
            return
        revision = self.grid.revision + 1
        box = (int(rows[0]), int(cols[0]), int(rows[-1]) + 1, int(cols[-1]) + 1)
        self._changes[revision] = GridWindow(*box)
        self.grid = OccupancyGrid(cells, self.grid.resolution_m, self.grid.origin_xy, revision)


def _moved(before: Pose2, after: Pose2) -> float:
    """Metres, a radian counted as one."""
    return before.distance_to(after) + abs(wrap_angle(after.yaw_rad - before.yaw_rad))


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]

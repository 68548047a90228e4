"""Lidar odometry: each scan is predicted, straightened, registered against the local map."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Imu, Pose2, Scan2D, WheelOdometry, wrap_angle
from explore_bt_slam.correlative import ScoreGrid, search
from explore_bt_slam.inertial import InertialFilter
from explore_bt_slam.options import KissGtsamOptions
from explore_bt_slam.point_to_line import Alignment, align
from explore_bt_slam.registration import KissRegistration
from explore_bt_slam.surfels import SurfelMap, normals_of
from explore_bt_slam.sweep import Sweep, deskew

__all__ = ["FrontEnd", "Registered"]

_FEWEST_POINTS = 15
_CARRIED_M = 2.0
_WEAK_SIGMA_M = 0.1
_OPEN_DIRECTION = "the walls in view leave one direction open, as in a plain corridor"
_LEAST_OVERLAP = 0.35
_DOUBTFUL_OVERLAP = 0.5
_DOUBTFUL_RESIDUAL_M = 0.04
_SURE_OVERLAP = 0.6
_CLEARLY_BETTER = 0.15
_GYRO_SLACK_RAD, _GYRO_SLACK_RPS = 0.04, 0.1
_LURCH_RAD = 0.2
_ABOUT_M = 1.0
_BLIND = np.diag([0.03, 0.03, 0.03]) ** 2
_BLIND_WINDOW_M = 0.25
_BLIND_WINDOW_MOST_M = 1.0
_BLIND_WINDOW_RAD = 0.35
_BLIND_WINDOW_MOST_RAD = 0.8
_BLIND_SCORE = 0.3
_AS_GOOD = 0.85
_FEW_M = 0.15
_ASTRAY_M = 0.8
"""A robot that nobody drives any more rolls on for so far: half a second until it brakes, and the braking."""
_ANCHOR = np.diag([0.003, 0.003, 0.001]) ** 2


@dataclass(frozen=True, slots=True, eq=False)
class Registered:
    """What became of a scan.

    Attributes:
        pose: ``T_map_base`` at its stamp.
        sweep: straightened by the motion found.
        covariance: (3, 3) float64 of the pose against the local map, base axes.
        overlap: share [0, 1] of the scan that the local map already holds.
        fits: False where scan and map contradict each other: it then goes into no map.
        weakness: what the lidar left open, in words; empty if nothing.
        problem: why the pose is hardly worth anything; empty if it is.
    """

    pose: Pose2
    sweep: Sweep
    covariance: NDArray[np.float64]
    overlap: float = 1.0
    fits: bool = True
    weakness: str = ""
    problem: str = ""


class FrontEnd:
    """Deskew, prediction, kiss-icp, point-to-line refinement."""

    def __init__(self, options: KissGtsamOptions, speed_limit_mps: float) -> None:
        self._max_range_m = options.match_range
        self._filter = InertialFilter(speed_limit_mps)
        self._kiss = KissRegistration(options.voxel)
        self._points = np.zeros((0, 2))
        self._surfels = SurfelMap((0.0, 0.0), 1.0)
        self._grid: ScoreGrid | None = None
        self._is_astray = False

    @property
    def motion(self) -> Pose2:
        """Predicted motion since the last scan."""
        return self._filter.motion

    @property
    def covariance(self) -> NDArray[np.float64]:
        """(3, 3) float64 of the present pose since the last keyframe, base axes."""
        return self._filter.covariance

    @property
    def time_s(self) -> float:
        """How far the prediction reaches."""
        return self._filter.time_s if self._filter.time_s is not None else 0.0

    @property
    def velocity_mps(self) -> NDArray[np.float64]:
        """(2,) float64: speed over ground in ``base_link`` axes, m/s."""
        return self._filter.velocity_mps

    def take_imu(self, imu: Imu) -> None:
        """Predict on."""
        self._filter.take_imu(imu)

    def take_odometry(self, odometry: WheelOdometry) -> None:
        """Correct the speed by the wheels."""
        self._filter.take_odometry(odometry)

    def take_step(self, off_m: float, span_s: float, sigma_m: float) -> None:
        """The camera says that the robot has come farther by ``off_m`` in the last ``span_s`` seconds."""
        if span_s > 0.0:
            self._filter.take_speed(float(self.velocity_mps[0]) + off_m / span_s, sigma_m / span_s)

    def first(self, scan: Scan2D, start: Pose2) -> Registered:
        """Straighten the first scan of all; there is nothing yet to register it against."""
        self._filter.advance_to(scan.stamp_s)
        pose = start.compose(self._filter.motion)
        sweep, covariance = self._keep_prediction(scan)
        return Registered(pose, sweep, covariance)

    def register(self, scan: Scan2D, last: Pose2) -> Registered:
        """Lay a scan into the local map; ``last`` is the pose of the scan before, ``map`` frame."""
        self._filter.advance_to(scan.stamp_s)
        self._filter.roll()
        if self._filter.is_blind:
            self._filter.loosen(_BLIND)
        trail, prediction = self._filter.trail, last.compose(self._filter.motion)
        covariance = self._filter.covariance
        slack_rad = self._turn_slack_rad(covariance, trail.span_s)
        points = deskew(scan, trail, self._max_range_m).points
        if min(points.shape[0], self._surfels.count_near(prediction.xy, self._max_range_m)) < _FEWEST_POINTS:
            return self._carried(scan, prediction)
        if self._is_astray:
            prediction, self._is_astray = self._placed(points, prediction), False
            # it did not come here during this sweep: nothing of that way may bend it
            last = prediction.compose(self._filter.motion.inverse())
        elif self._filter.is_blind and self._points.shape[0]:
            prediction = self._guessed(points, last, prediction)
        found = self._refine(points, self._kiss.align(points, prediction), prediction, covariance)
        if found.overlap < _DOUBTFUL_OVERLAP or found.residual_m > _DOUBTFUL_RESIDUAL_M:
            # where the prediction is wrong by a lurch of the wheels, "stood still" may be nearer
            sought = max(
                (self._searched(points, centre, covariance, slack_rad) for centre in (prediction, last)),
                key=lambda each: each.fitness,
            )
            is_sure = sought.overlap >= _SURE_OVERLAP and sought.residual_m <= _DOUBTFUL_RESIDUAL_M
            is_better = is_sure and sought.fitness > found.fitness + _CLEARLY_BETTER
            if is_better and not self._contradiction(sought, prediction, slack_rad, 1.0):
                found, covariance = sought, self._filter.distrust()
        known = self._known_share(points, prediction, found)
        if known * points.shape[0] < _FEWEST_POINTS:
            return self._carried(scan, prediction)
        problem = self._contradiction(found, prediction, slack_rad, known)
        if problem:
            return self._contradicted(scan, prediction, found.overlap, problem)
        motion = last.between(found.pose)
        sweep = deskew(scan, trail.corrected_to(motion), self._max_range_m)
        posterior = _inverse(_inverse(covariance) + _turned(found.information, -prediction.yaw_rad))
        self._filter.correct(motion, posterior)
        weakness = _OPEN_DIRECTION if found.weakest_sigma_m > _WEAK_SIGMA_M else ""
        return Registered(found.pose, sweep, posterior, found.overlap, weakness=weakness)

    def stand(self) -> None:
        """The robot was stopped, perhaps a little farther on: the next scan says where."""
        self._filter.stand()
        self._is_astray = True

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """What the prediction rests on; the local map is gathered anew."""
        return self._filter.arrays()

    def restore(self, arrays: Mapping[str, NDArray[np.float64]]) -> None:
        """Predict on from there."""
        self._filter.restore(arrays)

    def relocate(self, points: NDArray[np.float64], surfels: SurfelMap) -> None:
        """A keyframe was made here: take its surroundings as the local map, count errors from it.

        Args:
            points: (N, 2) float64, ``map`` frame.
            surfels: the same as line pieces.
        """
        self._points = points
        self._grid = None
        self._kiss.rebuild(points)
        self._surfels = surfels
        self._filter.anchor(_ANCHOR)

    def _refine(
        self, points: NDArray[np.float64], guess: Pose2, prior: Pose2, covariance: NDArray[np.float64]
    ) -> Alignment:
        information = _turned(_inverse(covariance), prior.yaw_rad)
        return align(points, normals_of(points), self._surfels, guess, prior, information)

    def _searched(
        self, points: NDArray[np.float64], prior: Pose2, covariance: NDArray[np.float64], slack_rad: float
    ) -> Alignment:
        """A doubtful match is sought again, by correlation and without the prediction's word."""
        window_m = min(3.0 * math.sqrt(float(np.linalg.eigvalsh(covariance[:2, :2])[-1])) + 0.3, 1.0)
        match = search(self._scores(), _few(points), prior, window_m, min(slack_rad, 0.5), rivals=1.0)
        return self._refine(points, match.pose, match.pose, np.eye(3))

    def _turn_slack_rad(self, covariance: NDArray[np.float64], span_s: float) -> float:
        """How far the heading may be off the prediction: wheels lurch, a gyroscope hardly lies."""
        gyro_rad = _GYRO_SLACK_RAD + _GYRO_SLACK_RPS * span_s
        slack_rad = gyro_rad if self._filter.feels_turns else _LURCH_RAD
        return 3.0 * math.sqrt(float(covariance[2, 2])) + slack_rad

    def _known_share(self, points: NDArray[np.float64], prediction: Pose2, found: Alignment) -> float:
        """Share of the scan that lies where the local map knows anything; asked only where little fits."""
        if found.overlap >= _LEAST_OVERLAP:
            return 1.0
        return self._surfels.share_known(prediction.apply(points), _ABOUT_M)

    def _contradiction(self, found: Alignment, prediction: Pose2, slack_rad: float, known: float) -> str:
        """What speaks against the match, in words; empty if nothing does.

        New walls speak neither for nor against: what fits is compared with the share that is ``known``.
        """
        if found.overlap < _LEAST_OVERLAP * known:
            return f"only {found.overlap:.0%} of the scan fits the map"
        turned_rad = abs(prediction.between(found.pose).yaw_rad)
        if self._filter.feels_turns and turned_rad > slack_rad:
            turn = f"{math.degrees(turned_rad):.0f}°"
            return f"the scan fits the map only after a turn of {turn} that the gyroscope did not feel"
        return ""

    def _guessed(self, points: NDArray[np.float64], last: Pose2, prediction: Pose2) -> Pose2:
        """Where a search about "stands still" and "goes on as before" lays the scan, if anywhere.

        With nothing but a lidar at 5 Hz the robot may have begun a turn since the last scan, and some
        loggers' stamps jitter by more than the time between scans.
        """
        moved_m = last.distance_to(prediction)
        turned = wrap_angle(prediction.yaw_rad - last.yaw_rad)
        middle = Pose2(
            0.5 * (last.x + prediction.x), 0.5 * (last.y + prediction.y), last.yaw_rad + 0.5 * turned
        )
        match = search(
            self._scores(),
            _few(points),
            middle,
            min(0.5 * moved_m + _BLIND_WINDOW_M, _BLIND_WINDOW_MOST_M),
            min(0.5 * abs(turned) + _BLIND_WINDOW_RAD, _BLIND_WINDOW_MOST_RAD),
            rivals=1.0,
            least=_BLIND_SCORE,
        )
        expected = search(self._scores(), _few(points), prediction, 0.0, 0.0, rivals=1.0)
        # along a plain wall all places fit alike: there the motion goes on as it was
        return prediction if expected.score >= _AS_GOOD * match.score else match.pose

    def _placed(self, points: NDArray[np.float64], believed: Pose2) -> Pose2:
        """Where about a place a scan fits, turned by anything; the place itself if it fits there as well."""
        scores, few = self._scores(), _few(points)
        match = search(scores, few, believed, _ASTRAY_M, math.pi, rivals=1.0, least=_BLIND_SCORE)
        expected = search(scores, few, believed, 0.0, 0.0, rivals=1.0)
        return believed if expected.score >= _AS_GOOD * match.score else match.pose

    def _scores(self) -> ScoreGrid:
        if self._grid is None:
            self._grid = ScoreGrid(self._points, 0.5)
        return self._grid

    def _carried(self, scan: Scan2D, prediction: Pose2) -> Registered:
        """Nothing here can be matched, as in the middle of a hall: the IMU carries the pose a while."""
        sweep, covariance = self._keep_prediction(scan)
        sigma_m = math.sqrt(float(np.linalg.eigvalsh(covariance[:2, :2])[-1]))
        text = f"next to nothing within {self._max_range_m:g} m to match; unsure by {sigma_m:.1f} m"
        problem = text if sigma_m > _CARRIED_M else ""
        return Registered(prediction, sweep, covariance, weakness=text, problem=problem)

    def _contradicted(self, scan: Scan2D, prediction: Pose2, overlap: float, problem: str) -> Registered:
        sweep, covariance = self._keep_prediction(scan)
        return Registered(prediction, sweep, covariance, overlap, fits=False, problem=problem)

    def _keep_prediction(self, scan: Scan2D) -> tuple[Sweep, NDArray[np.float64]]:
        sweep = deskew(scan, self._filter.trail, self._max_range_m)
        covariance = self._filter.covariance
        self._filter.correct(self._filter.motion, covariance)
        return sweep, covariance


def _few(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """About 100 of (N, 2) points, one a cell of 15 cm: else the nearest wall would outvote all others."""
    _, first = np.unique(np.floor(points / _FEW_M).astype(np.int64) @ (1, 4096), return_index=True)
    return points[np.sort(first)[:: max(first.shape[0] // 100, 1)]]


def _inverse(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def _turned(matrix: NDArray[np.float64], yaw_rad: float) -> NDArray[np.float64]:
    """A covariance or information of axes turned by ``yaw_rad``, in the axes they are turned against."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return turn @ matrix @ turn.T

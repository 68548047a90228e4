"""Lidar SLAM, step by step."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import RobotContext
from explore_bt.types import Estimate, Health, Imu, MapStructure, Pose2, RgbdFrame, Scan2D, WheelOdometry
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.camera import Camera
from explore_bt_slam.exported_graph import graph_of
from explore_bt_slam.front_end import FrontEnd, Registered
from explore_bt_slam.frozen_state import FrozenState
from explore_bt_slam.health import HealthMonitor
from explore_bt_slam.journal import Journal
from explore_bt_slam.keyframes import KeyframeRule
from explore_bt_slam.mapper import Mapper
from explore_bt_slam.options import KissGtsamOptions
from explore_bt_slam.scan_check import fault_of, without_body
from explore_bt_slam.seen_step import fuse_step
from explore_bt_slam.storage import (
    Arrays,
    pack_edges,
    unpack_edges,
    unpack_keyframes,
    unpack_sweeps,
)
from explore_bt_slam.sweep import Sweep

__all__ = ["Pipeline"]

_BACKWARDS_S = 0.05
_LOOK_S = 0.5
"""While the lidar leaves a direction open, an image is looked at so often."""
_SEEN_SHARE = 0.6
"""Of the way between keyframes: the views of two keyframes farther apart have too little in common."""
_UNRECOGNISED_S = 1.5
"""After so long without a view that is like the last keyframe's there is a new one."""
_SPEED_ERROR_MPS = 0.3
"""What the filter may be wrong by where only the IMU speaks, whatever it claims."""


class Pipeline:
    """One robot's SLAM, from measurements to pose and map.

    The robot is where it stands from a keyframe, plus the predicted motion since the last scan; so when
    the graph moves, everything moves along.

    Attributes:
        seen_s: when the camera last said how fast the robot goes.
    """

    def __init__(self, options: KissGtsamOptions, context: RobotContext) -> None:
        start, body_radius_m = context.start or Pose2.identity(), context.footprint_radius_m
        # a driver may overshoot its limit a little
        self.front = FrontEnd(options, 1.1 * context.limits.speed_mps)
        self.camera = Camera() if options.camera_closures else None
        self.back = BackEnd(options.loop_closures)
        self._map_range_m = options.max_range
        self.mapper = Mapper(options.resolution, body_radius_m)
        self.journal = Journal()
        self.health = HealthMonitor()
        self._rule = KeyframeRule(options.keyframe_distance, options.keyframe_angle)
        self._use_odometry = options.use_odometry
        self.mapper.begin(start, Pose2.identity())
        self._body_radius_m = body_radius_m
        self._start = start
        self._keyframe = -1
        self._weak_keyframes = 0
        self._looked_s = self.seen_s = -np.inf
        self._relative = Pose2.identity()
        self._scan_s = -np.inf
        self._covariance: tuple[int, int, NDArray[np.float64]] = (-1, 0, np.zeros((3, 3)))

    @property
    def pose(self) -> Pose2:
        """Where the robot is now, ``map`` frame."""
        return self._scan_pose.compose(self.front.motion)

    @property
    def has_begun(self) -> bool:
        """Whether a scan has been taken, or a map loaded."""
        return self._keyframe >= 0

    @property
    def _scan_pose(self) -> Pose2:
        if self._keyframe < 0:
            return self._start
        return self.back.pose(self._keyframe).compose(self._relative)

    def take_imu(self, imu: Imu) -> None:
        """A sample of the IMU."""
        numbers = (imu.stamp_s, *imu.angular_velocity_rps, *imu.linear_acceleration_mps2)
        if not np.isfinite(numbers).all():
            return
        if imu.stamp_s < self.front.time_s - _BACKWARDS_S:
            self.health.bad(imu.stamp_s, f"an IMU sample {self.front.time_s - imu.stamp_s:.3f} s old")
            return
        self.front.take_imu(imu)
        self.health.passed(imu.stamp_s)

    def take_odometry(self, odometry: WheelOdometry) -> None:
        """The wheels' word, heard only where the mission says so."""
        if self._use_odometry and np.isfinite([odometry.stamp_s, *odometry.T_odom_base.as_array()]).all():
            self.front.take_odometry(odometry)

    def take_image(self, frame: RgbdFrame) -> None:
        """An image; the next keyframe may want it."""
        if self.camera is None or self._keyframe < 0 or not np.isfinite(frame.stamp_s):
            return
        T_keyframe_base = self._relative.compose(self.front.motion)
        if self.back.looks.is_empty:
            self.back.looks.remember(self._keyframe, self.camera.first(frame, T_keyframe_base))
        else:
            self.camera.take(frame, T_keyframe_base)

    def take_scan(self, scan: Scan2D) -> None:
        """One scan, all the way to the map."""
        scan = without_body(scan, self._body_radius_m)
        problem = fault_of(scan, self._scan_s)
        if problem:
            self.health.bad(scan.stamp_s, problem)
            return
        self._scan_s = scan.stamp_s
        if self._keyframe < 0:
            self._begin(scan)
            return
        registered = self.front.register(scan, self._scan_pose)
        self._relative = self.back.pose(self._keyframe).between(registered.pose)
        self._judge(registered)
        if registered.fits:
            if self._rule.wants(self._relative, registered.overlap) or self._is_carried_along(registered):
                self._make_keyframe(registered)
            self._draw(registered.sweep)
        elif self.health.state[0] is Health.LOST:
            self._look_round(registered)
        self.journal.note(scan.stamp_s, self._keyframe, self._relative)

    def estimate(self) -> Estimate:
        """Pose, trust and map revision as they stand."""
        health, reason = self.health.state
        stamp_s = max(self.front.time_s, 0.0)
        return Estimate(stamp_s, self.pose, self._spread(), self.mapper.revision, health, reason)

    def figures(self) -> dict[str, float]:
        """Numbers for the report, but those of the graph."""
        return self.journal.figures()

    def structure(self) -> MapStructure:
        """The pose graph."""
        return MapStructure(graph=graph_of(self.back.poses, self.back.edges))

    def frozen(self) -> FrozenState:
        """The whole state, which goes on changing."""
        stamps, keyframes, relatives = self.journal.arrays()
        arrays = {
            **pack_edges(self.back.edges),
            **{name: array.copy() for name, array in self.mapper.arrays().items()},
            **self.back.looks.arrays(),
            **self.front.arrays(),
            "graph_poses": self.back.poses.copy(),
            "journal_stamps": stamps,
            "journal_keyframes": keyframes,
            "journal_relatives": relatives,
            "last_pose": self.pose.as_array(),
        }
        return FrozenState(tuple(self.back.keyframes), tuple(self.mapper.kept), arrays)

    def restore(self, arrays: Arrays, start: Pose2 | None) -> None:
        """Go on in a saved map, at ``start``, or where it ended if None."""
        poses = arrays["graph_poses"]
        if not poses.shape[0]:
            return
        self.back.restore(unpack_keyframes(arrays), poses, unpack_edges(arrays))
        self.back.looks.restore(arrays)
        self.mapper.restore(arrays, unpack_sweeps(arrays), poses)
        self.journal.restore(
            arrays["journal_stamps"], arrays["journal_keyframes"], arrays["journal_relatives"]
        )
        self._enter(start or Pose2(*arrays["last_pose"].tolist()))

    def go_on(self, arrays: Arrays) -> None:
        """After ``restore``: what comes next was measured right after the state was saved."""
        self.front.restore(arrays)

    def pick_up(self) -> None:
        """The robot was stopped meanwhile, and stands about where it was."""
        self.front.stand()

    def _begin(self, scan: Scan2D) -> None:
        first = self.front.first(scan, self._start)
        self._keyframe = self.back.begin(first.sweep, first.pose)
        self.front.relocate(*self.back.surroundings(self._keyframe))
        self.mapper.follow(self.back.poses)
        self._draw(first.sweep)
        self.health.good(scan.stamp_s)
        self.journal.note(scan.stamp_s, self._keyframe, self._relative)

    def _make_keyframe(self, registered: Registered) -> None:
        # while the lidar leaves a direction open, one error of speed runs through all keyframes: after n
        # of them it has grown to n σ and not to √n σ, so the n-th one adds (2 n − 1) σ²
        self._weak_keyframes = self._weak_keyframes + 1 if registered.weakness else 0
        covariance = registered.covariance * max(2 * self._weak_keyframes - 1, 1)
        sweep, sight = registered.sweep, None
        if self.camera is not None:
            sight = self.camera.sight(sweep.stamp_s, self._relative)
            covariance = self._seen_step(self.camera, sweep.stamp_s, covariance)
        self._keyframe = self.back.extend(sweep, self._keyframe, self._relative, covariance, sight)
        self._relative = Pose2.identity()
        self.front.relocate(*self.back.surroundings(self._keyframe))
        self.mapper.follow(self.back.poses)

    def _is_carried_along(self, registered: Registered) -> bool:
        """Whether the camera sees the robot move while the lidar leaves a direction open.

        A robot that takes itself for slow, or for standing, by an error of its speed would make no keyframe,
        and without one no step would be seen that mends the error.
        """
        stamp_s = registered.sweep.stamp_s
        if not registered.weakness or self.camera is None or stamp_s - self._looked_s < _LOOK_S:
            return False
        self._looked_s = stamp_s
        since_s = stamp_s - self.back.keyframes[self._keyframe].stamp_s
        look = self.camera.look(self._relative)
        if look.match is None:
            return look.is_rich and since_s >= _UNRECOGNISED_S
        step = look.match.relative
        return float(np.hypot(step.x, step.y)) >= _SEEN_SHARE * self._rule.distance_m

    def _seen_step(
        self, camera: Camera, stamp_s: float, covariance: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Where the lidar leaves a direction open, what the camera sees go by closes it.

        Corrects the step from the last keyframe, and the speed.

        Returns:
            The step's covariance, new keyframe's axes.
        """
        step = camera.step() if self._weak_keyframes else None
        span_s = stamp_s - self.back.keyframes[self._keyframe].stamp_s
        fused = fuse_step(self._relative, covariance, step, _SPEED_ERROR_MPS * span_s) if step else None
        if fused is None:
            return covariance
        relative, covariance = fused
        self.seen_s = stamp_s
        self.front.take_step(relative.x - self._relative.x, span_s, math.sqrt(float(covariance[0, 0])))
        self._relative = relative
        self._weak_keyframes = 0
        return covariance

    def _look_round(self, registered: Registered) -> None:
        """Lost: perhaps this is a place of the map after all."""
        found = self.back.recognise(registered.sweep, registered.pose)
        if found is not None:
            self._enter(found)

    def _enter(self, pose: Pose2) -> None:
        """Go on from the keyframe nearest to a pose in the map."""
        if self.camera is not None:
            self.camera.forget()
        poses = self.back.poses
        self._keyframe = int(np.argmin(np.hypot(poses[:, 0] - pose.x, poses[:, 1] - pose.y)))
        self._relative = self.back.pose(self._keyframe).between(pose)
        self.back.enter(self._keyframe)
        self.front.relocate(*self.back.surroundings(self._keyframe))

    def _draw(self, sweep: Sweep) -> None:
        self.mapper.see(
            sweep.cut(self._map_range_m), self._keyframe, self.back.pose(self._keyframe), self._relative
        )

    def _judge(self, registered: Registered) -> None:
        if registered.problem:
            self.health.bad(registered.sweep.stamp_s, registered.problem)
        else:
            self.health.good(registered.sweep.stamp_s, registered.weakness)

    def _spread(self) -> NDArray[np.float64]:
        """Keyframe's marginal and what has been driven since, ``map`` axes."""
        if self._keyframe < 0:
            return np.zeros((3, 3))
        key = (self._keyframe, self.back.closures)
        if self._covariance[:2] != key:
            self._covariance = (*key, self.back.covariance(self._keyframe))
        yaw, base = self.pose.yaw_rad, self.back.pose(self._keyframe)
        arm = np.eye(3)
        arm[0, 2], arm[1, 2] = base.y - self.pose.y, self.pose.x - base.x
        turn = np.eye(3)
        turn[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        spread = arm @ self._covariance[2] @ arm.T + turn @ self.front.covariance @ turn.T
        return np.asarray(0.5 * (spread + spread.T), dtype=np.float64)

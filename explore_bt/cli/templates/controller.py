"""A controller that turns towards a point ahead on the path, then drives to it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from pydantic import Field

from explore_bt import hookimpl
from explore_bt.interfaces import (
    API_VERSION,
    Controller,
    ControlOutput,
    ControlStatus,
    PluginOptions,
    RobotContext,
)
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2, Scan2D, Twist2, wrap_angle
from explore_bt.units import Angle, Duration, Length


class MyPlugin(Controller):
    """Turns towards the path, then drives along it; slows down before the end."""

    name = "my_plugin"
    api_version = API_VERSION

    class Options(PluginOptions):
        """What a mission may set: ``controller: {use: my_plugin, look_ahead: 30 cm}``."""

        look_ahead: Length = Field(0.3, gt=0.0, description="distance of the point that is driven to")
        reached: Length = Field(0.04, gt=0.0, description="how near to the goal is near enough")
        facing: Angle = Field(0.05, gt=0.0, description="how well it has to be faced")
        patience: Duration = Field(5.0, gt=0.0, description="without motion for so long is stuck")
        astray: Length = Field(0.5, gt=0.0, description="so far from the path is stuck")

    options: Options

    def setup(self, context: RobotContext) -> None:
        """Learn the limits."""
        self._limits: MotionLimits = context.limits
        self._path: Path | None = None
        self._begin()

    def follow(self, path: Path) -> None:
        """Follow this path from now on."""
        self._path = path
        self._begin()

    def hold(self) -> None:
        """Come to rest."""
        self._path = None
        self._begin()

    def step(
        self,
        estimate: Estimate,
        scan: Scan2D | None,  # noqa: ARG002  # the safety gate looks at the scan, this controller need not
        motion: MotionState,
        dt_s: float,
    ) -> ControlOutput:
        """The twist for the next period: what is wanted, shaped by the limits."""
        pose = estimate.T_map_base
        wanted, status = Twist2(), ControlStatus.IDLE
        if self._path is not None:
            wanted, status = self._wanted(pose, self._path)
        if status is ControlStatus.RUNNING:
            self._watch(pose, dt_s)
        if self._stuck:
            return ControlOutput(
                _shaped(Twist2(), motion, self._limits, dt_s), ControlStatus.STUCK, self._stuck
            )
        twist = _shaped(wanted, motion, self._limits, dt_s)
        if status is not ControlStatus.RUNNING and not twist.is_zero:
            return ControlOutput(twist, ControlStatus.RUNNING, "coming to rest")
        return ControlOutput(twist, status)

    def _begin(self) -> None:
        self._nearest, self._on_the_spot = 0, False
        self._stuck, self._still_s = "", 0.0
        self._was: Pose2 | None = None

    def _watch(self, pose: Pose2, dt_s: float) -> None:
        """Notice when the robot is carried off or does not get on; a tree decides what next."""
        if self._was is None or pose.distance_to(self._was) > 0.05 or abs(_turned(self._was, pose)) > 0.05:
            self._was, self._still_s = pose, 0.0
        self._still_s += dt_s
        if self._still_s > self.options.patience:
            self._stuck = f"not moved for {self._still_s:.0f} s"
        if self._away_m > self.options.astray:
            self._stuck = f"{self._away_m:.1f} m away from the path"

    def _wanted(self, pose: Pose2, path: Path) -> tuple[Twist2, ControlStatus]:
        """The twist to settle on, and whether the goal is reached."""
        left_m, ahead = pose.distance_to(path.goal), self._ahead(pose, path)
        self._on_the_spot |= left_m < self.options.reached / 2
        if self._on_the_spot and left_m < 2 * self.options.reached:
            error_rad = _turned(pose, path.goal)
            if abs(error_rad) < self.options.facing:
                return Twist2(), ControlStatus.ARRIVED
            return Twist2(0.0, self._turn_rate(error_rad)), ControlStatus.RUNNING
        return self._towards(ahead, pose, left_m), ControlStatus.RUNNING

    def _towards(self, point: tuple[float, float], pose: Pose2, left_m: float) -> Twist2:
        bearing_rad = math.atan2(point[1] - pose.y, point[0] - pose.x)
        error_rad = wrap_angle(bearing_rad - pose.yaw_rad)
        if abs(error_rad) > math.radians(30.0):
            return Twist2(0.0, self._turn_rate(error_rad))
        speed_mps = min(0.9 * self._limits.speed_mps, 0.6 * left_m) * math.cos(error_rad)
        return Twist2(speed_mps, self._turn_rate(error_rad))

    def _turn_rate(self, error_rad: float) -> float:
        largest = 0.9 * self._limits.turn_rate_rps
        return max(-largest, min(largest, 1.5 * error_rad))

    def _ahead(self, pose: Pose2, path: Path) -> tuple[float, float]:
        """The first point of the path that lies the look-ahead beyond the nearest one; never goes back."""
        away = np.hypot(path.poses[self._nearest :, 0] - pose.x, path.poses[self._nearest :, 1] - pose.y)
        self._nearest += int(np.argmin(away))
        self._away_m = float(away.min())
        rest = path.poses[self._nearest :]
        along = np.cumsum(np.hypot(np.diff(rest[:, 0]), np.diff(rest[:, 1])))
        ahead = min(int(np.searchsorted(along, self.options.look_ahead)) + 1, len(rest) - 1)
        return float(rest[ahead, 0]), float(rest[ahead, 1])


def _turned(before: Pose2, after: Pose2) -> float:
    return wrap_angle(after.yaw_rad - before.yaw_rad)


def _shaped(wanted: Twist2, motion: MotionState, limits: MotionLimits, dt_s: float) -> Twist2:
    linear = _towards_speed(
        wanted.linear_mps,
        motion.twist.linear_mps,
        motion.linear_acceleration_mps2,
        limits.acceleration_mps2,
        limits.jerk_mps3,
        dt_s,
    )
    angular = _towards_speed(
        wanted.angular_rps,
        motion.twist.angular_rps,
        motion.angular_acceleration_rps2,
        limits.turn_acceleration_rps2,
        limits.turn_jerk_rps3,
        dt_s,
    )
    return Twist2(linear, angular)


def _towards_speed(
    wanted: float, speed: float, acceleration: float, largest: float, jerk: float, dt_s: float
) -> float:
    """The next speed on the way to the wanted one, under limits of acceleration and jerk."""
    missing = wanted - speed
    # from acceleration a, ramping down to 0 at the jerk limit gains a²/2j (and half a period more)
    still = max(math.sqrt(2.0 * jerk * abs(missing) + (jerk * dt_s / 2) ** 2) - jerk * dt_s / 2, 0.0)
    goal = math.copysign(min(largest, still, abs(missing) / dt_s), missing)
    return speed + dt_s * max(acceleration - jerk * dt_s, min(acceleration + jerk * dt_s, goal))


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]

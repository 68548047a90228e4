"""A driver whose robot lives in an empty rectangular room."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from pydantic import Field

from explore_bt import hookimpl
from explore_bt.clock import Clock, ManualClock
from explore_bt.errors import PluginError, WorldError
from explore_bt.interfaces import API_VERSION, Driver, PluginOptions, RobotContext
from explore_bt.types import Measurement, MotionLimits, Pose2, Scan2D, Twist2, WheelOdometry
from explore_bt.units import Duration, Length

_STEP_S = 0.02
_SCAN_EVERY = 5
_SILENCE_S = 0.5
_ANGLES_RAD = np.linspace(-math.pi, math.pi, 360, endpoint=False)


class MyPlugin(Driver):
    """A round robot with a lidar in an empty room, without noise."""

    name = "my_plugin"
    api_version = API_VERSION

    class Options(PluginOptions):
        """What a mission may set: ``driver: {use: my_plugin, width: 8 m}``."""

        width: Length = Field(6.0, gt=0.0, description="the room along x, the origin in its middle")
        depth: Length = Field(4.0, gt=0.0, description="the room along y")
        radius: Length = Field(0.25, gt=0.0, description="radius of the robot")
        lidar_range: Length = Field(5.0, gt=0.0, description="how far the lidar sees")
        silence: Duration = Field(
            _SILENCE_S, gt=0.0, le=_SILENCE_S, description="halts without a command for so long"
        )

    options: Options

    def setup(self, context: RobotContext) -> None:
        """Put the robot at the start, in the middle of the room if nobody says where."""
        self._start = context.start or Pose2.identity()
        if min(self.options.width, self.options.depth) <= 2 * self.options.radius:
            raise PluginError(
                f"my_plugin: the robot of radius {self.options.radius} m does not fit into the room"
            )
        if not self._fits(self._start):
            raise WorldError(
                f"my_plugin: the start ({self._start.x:.2f}, {self._start.y:.2f}) is not in the room of "
                f"{self.options.width} m × {self.options.depth} m, {self.options.radius} m from its walls"
            )
        self._pose = self._start
        self._twist = Twist2()
        self._commanded_at_s = 0.0
        self._steps = 0
        self._pending: list[Measurement] = []
        self._clock = _RoomClock(self)

    @property
    def clock(self) -> Clock:
        """Simulated time: waiting moves the robot."""
        return self._clock

    @property
    def footprint_radius_m(self) -> float:
        """As set."""
        return self.options.radius

    @property
    def limits(self) -> MotionLimits:
        """The usual ones."""
        return MotionLimits()

    @property
    def start(self) -> Pose2:
        """Where it was put."""
        return self._start

    def read(self) -> Sequence[Measurement]:
        """What was measured since the last call."""
        measured, self._pending = self._pending, []
        return measured

    def command(self, twist: Twist2) -> None:
        """Drive at this twist until the next command."""
        limits = self.limits
        self._twist = Twist2(
            max(-limits.speed_mps, min(limits.speed_mps, twist.linear_mps)),
            max(-limits.turn_rate_rps, min(limits.turn_rate_rps, twist.angular_rps)),
        )
        self._commanded_at_s = self._clock.now_s()

    def stop(self) -> None:
        """Halt."""
        self._twist = Twist2()

    def close(self) -> None:
        """Halt; there is nothing to let go of."""
        self.stop()

    def advance(self, time_s: float) -> None:
        """Move the robot and take measurements up to ``time_s``; called by the clock."""
        while (stamp_s := (self._steps + 1) * _STEP_S) <= time_s + 1e-9:
            self._steps += 1
            if stamp_s - self._commanded_at_s > self.options.silence:
                self._twist = Twist2()
            self._move()
            self._pending.append(WheelOdometry(stamp_s, self._start.between(self._pose)))
            if self._steps % _SCAN_EVERY == 0:
                self._pending.append(self._scan(stamp_s))

    def _move(self) -> None:
        turn_rad = self._twist.angular_rps * _STEP_S
        ahead_m = self._twist.linear_mps * _STEP_S
        # driving along an arc: half of the turn before the step, half after it
        half = Pose2(0.0, 0.0, turn_rad / 2)
        moved = self._pose.compose(half).compose(Pose2(ahead_m, 0.0, turn_rad / 2))
        if self._fits(moved):
            self._pose = moved
        else:  # against a wall the wheels turn on the spot
            self._pose = self._pose.compose(Pose2(0.0, 0.0, turn_rad))

    def _fits(self, pose: Pose2) -> bool:
        free_x = self.options.width / 2 - self.options.radius
        free_y = self.options.depth / 2 - self.options.radius
        return abs(pose.x) <= free_x and abs(pose.y) <= free_y

    def _scan(self, stamp_s: float) -> Scan2D:
        """Exact distances to the four walls; +inf beyond the lidar's range."""
        cos, sin = np.cos(_ANGLES_RAD + self._pose.yaw_rad), np.sin(_ANGLES_RAD + self._pose.yaw_rad)
        with np.errstate(divide="ignore"):
            to_x = (np.copysign(self.options.width / 2, cos) - self._pose.x) / cos
            to_y = (np.copysign(self.options.depth / 2, sin) - self._pose.y) / sin
        ranges = np.minimum(to_x, to_y)
        ranges[ranges > self.options.lidar_range] = np.inf
        return Scan2D(
            stamp_s=stamp_s,
            angles_rad=_ANGLES_RAD,
            ranges_m=ranges.astype(np.float32),
            times_s=np.zeros(len(ranges)),
            range_min_m=0.05,
            range_max_m=self.options.lidar_range,
        )


class _RoomClock(ManualClock):
    """Advances the room while somebody waits."""

    def __init__(self, driver: MyPlugin) -> None:
        super().__init__()
        self._driver = driver

    def wait_until(self, time_s: float) -> None:
        """Let the robot drive until then."""
        self._driver.advance(time_s)
        super().wait_until(time_s)


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]

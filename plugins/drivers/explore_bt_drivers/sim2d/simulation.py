"""One robot in a world on a clock of its own making."""

from __future__ import annotations

import math

from explore_bt.clock import ManualClock
from explore_bt.interfaces import RobotContext
from explore_bt.types import Measurement, Pose2
from explore_bt_drivers.battery import BatteryGauge
from explore_bt_drivers.people import Crowd
from explore_bt_drivers.sim2d.body import Body
from explore_bt_drivers.sim2d.imu import InertialUnit
from explore_bt_drivers.sim2d.lidar import Lidar
from explore_bt_drivers.sim2d.motion import ON_STEP, STEP_S, X, Y
from explore_bt_drivers.sim2d.odometry import Wheels
from explore_bt_drivers.sim2d.options import Sim2dOptions
from explore_bt_drivers.sim2d.touches import Touches
from explore_bt_drivers.world import Scenery, World

__all__ = ["Simulation"]

_CHUNK_STEPS = 100


class Simulation(ManualClock):
    """Time, world, body and sensors: waiting moves the body on and queues what the sensors measure.

    The body moves in steps of ``STEP_S`` counted from 0, so that the same commands at the same times give
    the same states however the waiting is cut up. What changes in the world does so on a step, after all
    that was due by then has been measured; a sweep sees the version in which it ends.
    """

    def __init__(
        self, world: World, options: Sim2dOptions, start: Pose2, context: RobotContext, crowd: Crowd
    ) -> None:
        begin_s = context.resumed.stamp_s if context.resumed else 0.0
        super().__init__(begin_s)
        step = math.floor(begin_s / STEP_S + ON_STEP)
        self.body = Body(world, start, options.radius, options.limits, step)
        self.crowd = crowd
        self.touches = Touches(crowd, options.radius)
        self._scenery = Scenery(world, options.radius, STEP_S)
        self._lidar = Lidar(world, options, context.rng("lidar"), context.rng("lidar dropout"), crowd)
        self._sensors = (
            InertialUnit(options, context.rng("imu")),
            Wheels(options, start, context.rng("wheels")),
            self._lidar,
            *(() if options.battery_life is None else (BatteryGauge(options.battery_life),)),
        )
        self._queue: list[Measurement] = []
        for sensor in self._sensors:
            sensor.begin(self.body.track)

    def wait_until(self, time_s: float) -> None:
        """Advance the world to ``time_s``."""
        super().wait_until(time_s)
        last_step = math.floor(self.now_s() / STEP_S + ON_STEP)
        while self.body.track.last_step < last_step:
            self._advance(last_step)
            fresh = [found for sensor in self._sensors for found in sensor.measure(self.body.track)]
            fresh.sort(key=lambda measurement: measurement.stamp_s)
            self._queue += fresh

    def _advance(self, last_step: int) -> None:
        """Move on towards an internal step, at most to where the world may change."""
        track = self.body.track
        step = track.last_step
        world = self._scenery.settle(step, float(track.now[X]), float(track.now[Y]))
        self.body.world = self._lidar.world = world
        until = min(last_step, step + _CHUNK_STEPS, self._scenery.next_step(step))
        self.crowd.foresee(until * STEP_S)
        self.body.advance(until)
        self.touches.follow(track, step)

    def drain(self) -> list[Measurement]:
        """Everything measured since the last call, in time order."""
        measured, self._queue = self._queue, []
        return measured

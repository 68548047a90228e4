"""One robot in its world: body, sensors, and what they have measured."""

from __future__ import annotations

from explore_bt.interfaces import RobotContext
from explore_bt.types import Pose2
from explore_bt_drivers.battery import BatteryGauge
from explore_bt_drivers.people import Crowd
from explore_bt_drivers.sim2d.arena import Arena
from explore_bt_drivers.sim2d.body import Body, Track
from explore_bt_drivers.sim2d.company import Company
from explore_bt_drivers.sim2d.imu import InertialUnit
from explore_bt_drivers.sim2d.lidar import Lidar
from explore_bt_drivers.sim2d.motion import STEP_S
from explore_bt_drivers.sim2d.odometry import Wheels
from explore_bt_drivers.sim2d.options import Sim2dOptions
from explore_bt_drivers.sim2d.touches import Touches
from explore_bt_drivers.simulated import SensorDeck
from explore_bt_drivers.world import World

__all__ = ["Simulation"]


class Simulation:
    """A dweller of an arena."""

    def __init__(
        self, arena: Arena, options: Sim2dOptions, start: Pose2, context: RobotContext, crowd: Crowd
    ) -> None:
        world = arena.world
        self.body = Body(world, start, options.radius, options.limits, arena.step)
        self.crowd = crowd
        self.touches = Touches(crowd, options.radius)
        self._lidar = Lidar(
            world,
            options,
            context.rng("lidar"),
            context.rng("lidar dropout"),
            crowd,
            Company(arena.bodies),
        )
        sensors = (
            InertialUnit(options, context.rng("imu")),
            Wheels(options, start, context.rng("wheels")),
            self._lidar,
            *(() if options.battery_life is None else (BatteryGauge(options.battery_life),)),
        )
        self.sensors: SensorDeck[Track] = SensorDeck(sensors, self.body.track)
        arena.admit(self)

    def enter(self, world: World) -> None:
        """The version of the world that is in force from now on."""
        self.body.world = self._lidar.world = world

    def advance(self, last_step: int) -> None:
        """Move on to an internal step, people too."""
        step = self.body.track.last_step
        self.crowd.foresee(last_step * STEP_S)
        self.body.advance(last_step)
        self.touches.follow(self.body.track, step)

    def measure(self) -> None:
        """Take what the sensors have to tell by now."""
        self.sensors.measure(self.body.track)

"""Driver ``sim2d``: a robot simulated in the plane, the embedded default."""

from __future__ import annotations

from typing import ClassVar

from explore_bt.clock import Clock
from explore_bt.interfaces import API_VERSION, PluginOptions, RobotContext
from explore_bt.types import MotionLimits, Pose2, Twist2
from explore_bt_drivers.people import Crowd
from explore_bt_drivers.sim2d.arena import Arena
from explore_bt_drivers.sim2d.options import Sim2dOptions
from explore_bt_drivers.sim2d.simulation import Simulation
from explore_bt_drivers.sim2d.truth import Sim2dTruth
from explore_bt_drivers.sim2d.venue import Venue
from explore_bt_drivers.simulated import SimulatedDriver
from explore_bt_drivers.world import World, observable_floor, stand_of

__all__ = ["Sim2d"]

_WARM_UP_S = 0.2


class Sim2d(SimulatedDriver[Simulation]):
    """A round robot with lidar, IMU and slipping wheels among people, in a drawn world or a ROS map.

    The ``map`` frame is the world's own. Robots of one mission whose worlds are the same file share it: they
    see one another and can run into one another. Time passes only while someone waits on the clock; the same
    world, options, seed and commands give the same measurements, bit for bit.
    """

    name = "sim2d"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = Sim2dOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        assert isinstance(options, Sim2dOptions)
        self._options = options
        self._arena: Arena | None = None

    def setup(self, context: RobotContext) -> None:
        """Load the world, place the robot, compile the kernels.

        Raises:
            WorldError: a world that cannot be used, a start inside an obstacle, no floor for walkers.
        """
        options = self._options
        venue = Venue.of(options, context)
        world, arena = venue.world, venue.arena
        start = venue.start(options, context)
        self._start = start if context.start is None else context.start
        stand = stand_of(world, context.resumed, options.radius) or start
        _rehearse(world, options, stand, context, venue.crowd(options, context, start))
        observable_floor(world, start.xy, options.radius, 0.0)
        crowd = venue.crowd(options, context, start)
        self._arena = arena
        self._simulation = Simulation(arena, options, stand, context, crowd)
        self._truth = Sim2dTruth(arena, start, self._simulation, options.lidar_range)

    @property
    def clock(self) -> Clock:
        """Simulated time, the same for all robots in this world: waiting on it moves them all."""
        self._running()
        assert self._arena is not None
        return self._arena

    @property
    def command_delay_s(self) -> float:
        """Half a control period at 20 Hz: the body glides from one command to the next."""
        return 0.025

    @property
    def footprint_radius_m(self) -> float:
        """Radius of the circular footprint."""
        return self._options.radius

    @property
    def limits(self) -> MotionLimits:
        """What the simulated body can do."""
        return self._options.limits


def _rehearse(world: World, options: Sim2dOptions, stand: Pose2, context: RobotContext, crowd: Crowd) -> None:
    """Compile every kernel, in a world apart."""
    arena = Arena(world, context.resumed.stamp_s if context.resumed else 0.0)
    rehearsal = Simulation(arena, options, stand, context, crowd)
    rehearsal.body.command(Twist2(0.1, 0.1))
    arena.wait_until(arena.now_s() + _WARM_UP_S)

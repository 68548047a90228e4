"""Driver ``mujoco``: a balancing robot with 3D lidar, IMU and camera, simulated with all its physics."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from explore_bt.clock import Clock
from explore_bt.interfaces import API_VERSION, Filming, PluginOptions, RobotContext
from explore_bt.types import BodyFault, BodyShape, MotionLimits, Twist2
from explore_bt_drivers.mujoco.figures import BODY_HEIGHT_M, FORESIGHT_S, STEP_M
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.people import Town
from explore_bt_drivers.simulated import SimulatedDriver
from explore_bt_drivers.world import choose_start, load_world, observable_floor, stand_of

if TYPE_CHECKING:  # the physics is imported in ``setup``: missions are checked without it
    from explore_bt_drivers.mujoco.simulation import Simulation  # noqa: F401  # for the base class

__all__ = ["Mujoco"]

_WARM_UP_S = 0.2
_GLIDE_S = 0.025
"""Half a control period at 20 Hz: set-points glide from one command to the next."""


class Mujoco(SimulatedDriver["Simulation"]):
    """The paper's robot: two wheels, 22 kg, VLP-16, IMU, RGB-D camera, among people in a world or a ROS map.

    The ``map`` frame is the world's own. ``base_link`` is fixed to the body: under the middle of the axle, on
    the floor while the body stands upright. Time passes only while someone waits on the clock; the same
    world, options, seed and commands give the same measurements, bit for bit.
    """

    name = "mujoco"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = MujocoOptions
    films = True
    shows_mates = False

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        assert isinstance(options, MujocoOptions)
        self._options = options

    def setup(self, context: RobotContext) -> None:
        """Load the world, build the scene, place the robot, compile the kernels.

        Raises:
            WorldError: a world that cannot be used, a start inside an obstacle, no floor for walkers.
            PluginError: a camera is asked for, and no library can draw.
        """
        from explore_bt_drivers.mujoco.scene import build_scene
        from explore_bt_drivers.mujoco.simulation import Simulation, compiled
        from explore_bt_drivers.mujoco.truth import MujocoTruth

        options = self._options
        world = load_world(options.world)
        self._start = choose_start(world, context.start, options.footprint_m)
        stand = stand_of(world, context.resumed, options.footprint_m) or self._start
        town = Town(
            world,
            self._start.xy,
            options.walkers,
            walker_radius_m=options.walker_radius,
            walker_speed_mps=options.walker_speed,
        )
        scene = build_scene(world, town.crowd(context.rng("walkers")), context.rng("scene"))
        model = compiled(scene, stand)
        rehearsal = Simulation(scene, model, options, context)
        rehearsal.body.command(Twist2(0.1, 0.1))
        rehearsal.wait_until(rehearsal.now_s() + _WARM_UP_S)
        rehearsal.close()
        observable_floor(world, self._start.xy, options.footprint_m, 0.0)
        self._simulation = Simulation(scene, model, options, context)
        self._truth = MujocoTruth(
            world, self._start, self._simulation, options.footprint_m, options.lidar_range
        )

    @property
    def clock(self) -> Clock:
        """Simulated time: waiting on it moves the robot."""
        return self._running()

    @property
    def command_delay_s(self) -> float:
        """The body acts on commands after it has leant for them."""
        return FORESIGHT_S + _GLIDE_S

    @property
    def footprint_radius_m(self) -> float:
        """Radius that is kept clear: as the mission says, and not less than the body's own."""
        return self._options.footprint_m

    @property
    def shape(self) -> BodyShape:
        """What passes under and over what."""
        return BodyShape(BODY_HEIGHT_M, STEP_M)

    @property
    def limits(self) -> MotionLimits:
        """What the body can do."""
        return self._options.limits

    @property
    def fault(self) -> BodyFault | None:
        """Whether it has fallen, or is being stood up."""
        return None if self._simulation is None else self._simulation.fault

    def recover(self) -> bool:
        """Have somebody stand it up, which takes some seconds."""
        self._running().stand_up()
        return True

    def close(self) -> None:
        """Stop; later commands are not heard."""
        if self._simulation is not None and not self._closed:
            self._simulation.close()
        super().close()

    def filming(self, size: tuple[int, int]) -> Filming:
        """The robot in its world from above, and what its camera looks at in a corner.

        Raises:
            UserError: the library that draws is missing.
        """
        from explore_bt_drivers.mujoco.filming import WorldFilm

        simulation = self._running()
        return WorldFilm(
            simulation.model,
            simulation.surroundings,
            size,
            self._options.camera_mount,
            lambda: (simulation.body.track, simulation.data.qpos),
        )

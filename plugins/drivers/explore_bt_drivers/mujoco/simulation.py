"""One robot in a physical world on a clock of its own making."""

from __future__ import annotations

import itertools
import math

import mujoco

from explore_bt.clock import ManualClock
from explore_bt.interfaces import RobotContext
from explore_bt.types import BodyFault, BodyFaultKind, Pose2
from explore_bt_drivers.battery import BatteryGauge
from explore_bt_drivers.mujoco.body import Body, Stance, add_robot
from explore_bt_drivers.mujoco.camera import RgbdCamera
from explore_bt_drivers.mujoco.contacts import Contacts
from explore_bt_drivers.mujoco.encoders import Encoders
from explore_bt_drivers.mujoco.figures import BODY_RADIUS_M
from explore_bt_drivers.mujoco.imu import InertialUnit
from explore_bt_drivers.mujoco.lidar import VelodyneLike
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.scene import Scene, Surroundings
from explore_bt_drivers.mujoco.track import ON_STEP, STEP_S, Track
from explore_bt_drivers.simulated import SensorDeck

__all__ = ["Simulation", "compiled"]

_CHUNK_STEPS = 50
_HAND_STEP_M, _HAND_CELLS = 0.05, 20
"""Places up to 1 m from where a robot lies are tried for standing it up."""
_FAULTS = {
    Stance.FALLEN: BodyFault(BodyFaultKind.FALLEN, "the robot has fallen"),
    Stance.LIFTED: BodyFault(BodyFaultKind.RECOVERING, "the robot is being stood up"),
}


def compiled(scene: Scene, stand: Pose2) -> mujoco.MjModel:
    """The model of a scene with the robot in it."""
    add_robot(scene.spec, stand)
    scene.spec.option.timestep = STEP_S
    return scene.spec.compile()


class Simulation(ManualClock):
    """Time, world, body and sensors: waiting moves the body on and queues what the sensors measure.

    Physics goes in steps of ``STEP_S`` counted from 0, so that the same commands at the same times give the
    same states however the waiting is cut up. What moves in the world is moved before each step.
    """

    def __init__(
        self, scene: Scene, model: mujoco.MjModel, options: MujocoOptions, context: RobotContext
    ) -> None:
        begin_s = context.resumed.stamp_s if context.resumed else 0.0
        super().__init__(begin_s)
        step = math.floor(begin_s / STEP_S + ON_STEP)
        self.model, self.data = model, mujoco.MjData(model)
        self.surroundings = Surroundings(scene, model, options.footprint_m)
        self.body = Body(model, self.data, options.limits, step)
        self.surroundings.settle(self.data, step, *self.body.pose.xy)
        self.contacts = Contacts(model)
        self._cameras = (
            ()
            if options.image_size is None
            else (RgbdCamera(model, self.surroundings, options, context.rng("camera")),)
        )
        sensors = (
            InertialUnit(options, context.rng("imu")),
            Encoders(options, context.rng("wheels")),
            VelodyneLike(self.surroundings, options, context.rng("lidar")),
            *self._cameras,
            *(() if options.battery_life is None else (BatteryGauge(options.battery_life),)),
        )
        self.sensors: SensorDeck[Track] = SensorDeck(sensors, self.body.track)

    def wait_until(self, time_s: float) -> None:
        """Advance the world to ``time_s``."""
        super().wait_until(time_s)
        last_step = math.floor(self.now_s() / STEP_S + ON_STEP)
        while self.body.track.last_step < last_step:
            self._advance(min(last_step, self._next_stop()))
            self.sensors.measure(self.body.track)

    @property
    def fault(self) -> BodyFault | None:
        """Why the body cannot drive; None while it stands."""
        return _FAULTS.get(self.body.stance)

    def stand_up(self) -> None:
        """Have a fallen robot stood up, as near to where it lies as there is room."""
        x, y = self.body.pose.xy
        world, steps = self.surroundings.world, range(-_HAND_CELLS, _HAND_CELLS + 1)
        about = sorted(itertools.product(steps, steps), key=lambda step: math.hypot(*step))
        places = ((x + _HAND_STEP_M * dx, y + _HAND_STEP_M * dy) for dx, dy in about)
        self.body.stand_up(next((at for at in places if world.clearance_m(*at) > BODY_RADIUS_M), (x, y)))

    def close(self) -> None:
        """Let go of what sensors hold. Idempotent."""
        for camera in self._cameras:
            camera.close()

    def _next_stop(self) -> int:
        """The step at which to look at sensors again, counted from 0: it does not depend on the waiting."""
        return (self.body.track.last_step // _CHUNK_STEPS + 1) * _CHUNK_STEPS

    def _advance(self, last_step: int) -> None:
        track, body = self.body.track, self.body
        while track.last_step < last_step:
            x, y = track.now[:2].tolist()
            self.surroundings.settle(self.data, track.last_step, x, y)
            body.advance(track.last_step + 1)
            self.contacts.follow(self.data, body.own_speed_mps)

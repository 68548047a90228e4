"""The robot's body in its scene: commands in, a track of states out."""

from __future__ import annotations

from enum import Enum

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, Pose2, Twist2
from explore_bt_drivers.mujoco.body.balance import CONTROL_S, Balance
from explore_bt_drivers.mujoco.body.build import Joints
from explore_bt_drivers.mujoco.body.footing import footing
from explore_bt_drivers.mujoco.body.foresight import Foresight, Wish
from explore_bt_drivers.mujoco.body.lift import Lift
from explore_bt_drivers.mujoco.body.plant import Plant
from explore_bt_drivers.mujoco.body.posture import pitch_of, planar_pose, roll_of
from explore_bt_drivers.mujoco.figures import WHEEL_RADIUS_M
from explore_bt_drivers.mujoco.track import STEP_S, Track
from explore_bt_drivers.orders import Orders, driven

__all__ = ["Body", "Stance"]

_STEPS = round(CONTROL_S / STEP_S)
_FALLEN_RAD = 0.6
"""No pitch from which this body comes back."""
_CALM_STEPS = round(1.5 / STEP_S)
"""A body that was stood up sways for so long."""
_STILL = (0.0, 0.0, 0.0, 0.0)


class Stance(Enum):
    """Whether the body can drive."""

    STANDING = "standing"
    FALLEN = "fallen"
    LIFTED = "being stood up"


class Body:
    """Balances, drives as it is told, falls over when pushed too hard, and can be stood up again.

    See ``Orders`` for how commands become set-points, ``Foresight`` for what becomes of these. A body that
    has fallen switches its motors off.

    ``command`` and ``advance`` belong to one thread; ``halt`` may be called from any.

    Attributes:
        track: where it has been.
        stance: whether it can drive.
        falls: how often it has fallen.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, limits: MotionLimits, step: int = 0
    ) -> None:
        """Take charge of the robot in a model, and put its wheels on what is under them there."""
        self._model, self._data = model, data
        plant = Plant.of(model)
        self._balance, self._foresight = Balance(plant), Foresight(plant, CONTROL_S)
        self._orders = Orders(limits, CONTROL_S)
        self._speeds = (limits.speed_mps, limits.acceleration_mps2, limits.jerk_mps3)
        self._turns = (limits.turn_rate_rps, limits.turn_acceleration_rps2, limits.turn_jerk_rps3)
        base = model.joint(Joints.BASE)
        wheels = [model.joint(name) for name in Joints.WHEELS]
        self._qpos, self._qvel = int(base.qposadr[0]), int(base.dofadr[0])
        self._wheel_qpos = [int(wheel.qposadr[0]) for wheel in wheels]
        self._wheel_qvel = [int(wheel.dofadr[0]) for wheel in wheels]
        self._motors = [model.actuator(name).id for name in Joints.WHEELS]
        self._accelerometer = int(model.sensor("accelerometer").adr[0])
        self._row, self._wish = np.zeros(15), Wish()
        self._lift: Lift | None = None
        self._calm_step = 0
        self.stance = Stance.STANDING
        self.falls = 0
        mujoco.mj_forward(model, data)
        at = self._qpos
        here = planar_pose(data.qpos[at : at + 3].tolist(), data.qpos[at + 3 : at + 7].tolist())
        data.qpos[at : at + 7] = footing(model, data, here)
        mujoco.mj_forward(model, data)
        self.track = Track(self._state(), step)
        self._setpoint = _STILL

    @property
    def pose(self) -> Pose2:
        """Where ``base_link`` is now, seen from above, ``map`` frame."""
        state = self.track.now.tolist()
        return planar_pose(state[:3], state[3:7])

    @property
    def own_speed_mps(self) -> float:
        """What it is driving at of its own will; being pushed is none of it."""
        return self._wish.speed_mps

    def command(self, twist: Twist2) -> None:
        """Go for a twist from the next control period on."""
        self._orders.command(twist, self.track.last_step // _STEPS, self._setpoint)

    def halt(self) -> None:
        """Brake as the limits allow and stand until the next command."""
        self._orders.halt()

    def stand_up(self, where: tuple[float, float] | None = None) -> None:
        """Have a fallen body stood up, as a hand would do it, and held until it balances; takes 3.5 seconds.

        Args:
            where: its axle is to stand, metres, ``map`` frame; None: where it lies.
        """
        if self.stance is Stance.FALLEN:
            self.halt()
            here = self.pose
            stand = Pose2(*where, here.yaw_rad) if where else here
            self._lift = Lift(self.track.now, footing(self._model, self._data, stand))
            self.stance = Stance.LIFTED

    def advance(self, last_step: int) -> None:
        """Move on to an internal step."""
        while self.track.last_step < last_step:
            if self.track.last_step % _STEPS == 0:
                self._control(self.track.last_step // _STEPS)
            if self._lift is not None:
                self._be_lifted(self._lift)
            else:
                mujoco.mj_step(self._model, self._data)
            self.track.add(self._state())

    def _control(self, period: int) -> None:
        if self.stance is Stance.LIFTED and self._lift is None and self.track.last_step >= self._calm_step:
            self.stance = Stance.STANDING
        if self.stance is Stance.STANDING:
            self._find_fall()
        order = self._orders.at(period)
        v, a, w, alpha = self._setpoint
        a_next = driven(order.linear, period, v, a, self._speeds, CONTROL_S)
        alpha_next = driven(order.angular, period, w, alpha, self._turns, CONTROL_S)
        v += 0.5 * (a + a_next) * CONTROL_S
        w += 0.5 * (alpha + alpha_next) * CONTROL_S
        self._setpoint = (v, a_next, w, alpha_next)
        self._wish = self._foresight.wish(self._setpoint)
        if self.stance is Stance.STANDING or (self.stance is Stance.LIFTED and self._lift is None):
            self._data.ctrl[self._motors] = self._balance.torques(self._felt(), self._wish)
        else:
            self._data.ctrl[self._motors] = 0.0

    def _felt(self) -> tuple[float, float, float, float]:
        """As encoders and gyroscope of the drive's own would have it, without noise."""
        pitch = pitch_of(*self._data.qpos[self._qpos + 3 : self._qpos + 7].tolist())
        _, pitch_rate, turn_rate = self._data.qvel[self._qvel + 3 : self._qvel + 6].tolist()
        left, right = (float(self._data.qvel[at]) for at in self._wheel_qvel)
        return (WHEEL_RADIUS_M * (0.5 * (left + right) + pitch_rate), pitch, pitch_rate, turn_rate)

    def _find_fall(self) -> None:
        quaternion = self._data.qpos[self._qpos + 3 : self._qpos + 7].tolist()
        if max(abs(pitch_of(*quaternion)), abs(roll_of(*quaternion))) > _FALLEN_RAD:
            self.stance = Stance.FALLEN
            self.falls += 1
            self.halt()

    def _be_lifted(self, lift: Lift) -> None:
        data, at = self._data, self._qvel
        data.qpos[self._qpos : self._qpos + 7], data.qvel[at : at + 6] = lift.next()
        data.qvel[self._wheel_qvel] = 0.0
        data.time += STEP_S
        mujoco.mj_forward(self._model, data)
        if lift.is_over:
            self._lift, self._calm_step = None, self.track.last_step + _CALM_STEPS
            self._rest()

    def _rest(self) -> None:
        self._setpoint = _STILL
        self._foresight.forget()
        self._balance.forget()

    def _state(self) -> NDArray[np.float64]:
        """The track's row; what the IMU feels is that of the step which ends now."""
        data, row = self._data, self._row
        row[:7] = data.qpos[self._qpos : self._qpos + 7]
        row[7:10] = data.qvel[self._qvel + 3 : self._qvel + 6]
        row[10:13] = data.sensordata[self._accelerometer : self._accelerometer + 3]
        row[13:] = data.qpos[self._wheel_qpos]
        return row

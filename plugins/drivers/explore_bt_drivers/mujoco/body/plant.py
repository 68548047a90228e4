"""A wheeled inverted pendulum as equations: what the balance is designed on.

The body (mass m, centre of mass l above the axle, inertia I about it) stands on two wheels (mass and inertia
of both: M, J; radius r). With x the way of the axle, θ the pitch (nose down positive) and τ the torque of
both motors, about standing upright::

    (M + m + J / r²) x'' + m l θ''       = τ / r
     m l x''             + (I + m l²) θ'' = m g l θ - τ

As for Grasser et al. 2002 ("JOE"); the torque acts between body and wheels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from explore_bt_drivers.mujoco.body.build import Joints
from explore_bt_drivers.mujoco.figures import TRACK_M, WHEEL_RADIUS_M

__all__ = ["Plant"]


@dataclass(frozen=True, slots=True)
class Plant:
    """The figures of the equations, SI.

    Attributes:
        body_kg, above_m, body_kgm2: m, l, I.
        wheels_kg, wheels_kgm2: M, J.
        yaw_kgm2: inertia of all about the vertical axis, the wheels' rolling included.
        lean_rad: pitch at which the centre of mass is above the axle.
        wheel_m, track_m: radius of a wheel, and what is between their middles.
        gravity_mps2: g.
    """

    body_kg: float
    above_m: float
    body_kgm2: float
    wheels_kg: float
    wheels_kgm2: float
    yaw_kgm2: float
    lean_rad: float
    wheel_m: float = WHEEL_RADIUS_M
    track_m: float = TRACK_M
    gravity_mps2: float = 9.81

    @classmethod
    def of(cls, model: mujoco.MjModel) -> Plant:
        """Read off a compiled model, in which masses and sizes are those of ``build``."""
        base = model.body(Joints.BASE)
        wheels = [model.body(name) for name in Joints.WHEELS]
        rotation = np.empty(9)
        mujoco.mju_quat2Mat(rotation, base.iquat)
        axes = rotation.reshape(3, 3)
        tensor = axes @ np.diag(base.inertia) @ axes.T
        ahead, up = float(base.ipos[0]), float(base.ipos[2]) - WHEEL_RADIUS_M
        mass, wheel_mass = float(base.mass[0]), sum(float(wheel.mass[0]) for wheel in wheels)
        spin = sum(
            float(max(wheel.inertia)) for wheel in wheels
        )  # a flat cylinder is stiffest about its axle
        across = sum(float(min(wheel.inertia)) for wheel in wheels)
        lever = 0.5 * TRACK_M
        yaw = tensor[2, 2] + across + (wheel_mass + spin / WHEEL_RADIUS_M**2) * lever**2
        return cls(
            body_kg=mass,
            above_m=math.hypot(ahead, up),
            body_kgm2=float(tensor[1, 1]),
            wheels_kg=wheel_mass,
            wheels_kgm2=spin,
            yaw_kgm2=float(yaw),
            lean_rad=-math.atan2(ahead, up),
        )

    @property
    def rolling_kg(self) -> float:
        """What has to be accelerated along the floor: all mass, and the wheels' spin."""
        return self.wheels_kg + self.body_kg + self.wheels_kgm2 / self.wheel_m**2

    def linear(self, period_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(4, 4) and (4, 1) float64: next state from (x, x', θ, θ') and the torque held over a period."""
        moment = self.body_kg * self.above_m
        mass = np.array([[self.rolling_kg, moment], [moment, self.body_kgm2 + moment * self.above_m]])
        by_pitch, by_torque = (
            np.linalg.solve(mass, forces)
            for forces in ([0.0, moment * self.gravity_mps2], [1.0 / self.wheel_m, -1.0])
        )
        rates = np.zeros((5, 5))
        rates[0, 1] = rates[2, 3] = 1.0
        rates[1, 2], rates[3, 2] = by_pitch
        rates[1, 4], rates[3, 4] = by_torque
        both = expm(rates * period_s)
        return both[:4, :4], both[:4, 4:]

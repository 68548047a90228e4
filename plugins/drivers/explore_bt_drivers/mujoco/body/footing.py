"""How a body stands on what is under its wheels: the floor, a sill, a ramp."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_drivers.mujoco.body.posture import upright
from explore_bt_drivers.mujoco.figures import STEP_M, TRACK_M, WHEEL_RADIUS_M
from explore_bt_drivers.mujoco.scene.groups import GeomGroup

__all__ = ["footing"]

_ABOVE_M = 0.01
_TREAD_M = np.linspace(-0.06, 0.06, 13)
"""A sill of 2 cm touches a wheel up to 6 cm ahead of the axle."""
_DOWN = np.array([0.0, 0.0, -1.0])
_SEEN = np.array([group != GeomGroup.ROBOT for group in range(mujoco.mjNGROUP)], dtype=np.uint8)


def footing(model: mujoco.MjModel, data: mujoco.MjData, pose: Pose2) -> NDArray[np.float64]:
    """(7,) float64: position and quaternion (w x y z) of ``base_link`` where both wheels rest at that pose.

    The body leans sideways where one wheel rests higher, and stands upright in its direction of travel.

    Args:
        model: with all that can be stood on; what is ``STEP_M`` high or higher cannot.
        data: of that model, positions up to date.
        pose: seen from above, ``map`` frame.
    """
    left, right = (_rest_m(model, data, pose, side * TRACK_M / 2) for side in (1.0, -1.0))
    roll = math.asin((left - right) / TRACK_M)
    turned, leant = (
        np.array(upright(pose.yaw_rad)),
        np.array([math.cos(roll / 2), math.sin(roll / 2), 0.0, 0.0]),
    )
    quaternion = np.empty(4)
    mujoco.mju_mulQuat(quaternion, turned, leant)
    axle = np.array([pose.x, pose.y, WHEEL_RADIUS_M + (left + right) / 2])
    up = np.empty(3)
    mujoco.mju_rotVecQuat(up, -_DOWN, quaternion)
    return np.concatenate((axle - WHEEL_RADIUS_M * up, quaternion))


def _rest_m(model: mujoco.MjModel, data: mujoco.MjData, pose: Pose2, aside_m: float) -> float:
    """How much higher than on the floor a wheel rests."""
    tread = pose.apply(np.column_stack((_TREAD_M, np.full(len(_TREAD_M), aside_m))))
    rim_m = WHEEL_RADIUS_M - np.sqrt(WHEEL_RADIUS_M**2 - _TREAD_M**2)
    heights = np.array([_floor_m(model, data, x, y) for x, y in tread.tolist()])
    return float((heights - rim_m).max())


def _floor_m(model: mujoco.MjModel, data: mujoco.MjData, x: float, y: float) -> float:
    eye = np.array([x, y, STEP_M + _ABOVE_M])
    down_m = mujoco.mj_ray(model, data, eye, _DOWN, _SEEN, 1, -1, None)
    return float(eye[2] - down_m) if down_m >= 0.0 else 0.0

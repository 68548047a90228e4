"""Where a command leads: a control period, then the jerk-limited brake to rest, turning included."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.runtime.brake import brake_duration_s, brake_velocity
from explore_bt.types import MotionLimits, MotionState, Pose2

__all__ = ["WayToRest", "brake_velocities", "way_to_rest"]

SAMPLE_S = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class WayToRest:
    """Samples from here to rest; the first is here and now.

    Attributes:
        poses: (N, 3) float64 x, y in metres, ``map`` frame, yaw.
        times_s: (N,) float64, seconds from now.
        speeds_mps: (N,) float64, along the robot's x, without sign.
    """

    poses: NDArray[np.float64]
    times_s: NDArray[np.float64]
    speeds_mps: NDArray[np.float64]


def way_to_rest(
    following: MotionState, pose: Pose2, motion: MotionState, limits: MotionLimits, dt_s: float
) -> WayToRest:
    """Where the robot comes to rest if it brakes right after the coming period.

    Args:
        following: the motion at the end of the period.
        pose: the robot's pose now, ``map`` frame.
        motion: the motion now.
        limits: of the brake.
        dt_s: the control period.
    """
    duration = max(
        brake_duration_s(
            following.twist.linear_mps,
            following.linear_acceleration_mps2,
            limits.acceleration_mps2,
            limits.jerk_mps3,
        ),
        brake_duration_s(
            following.twist.angular_rps,
            following.angular_acceleration_rps2,
            limits.turn_acceleration_rps2,
            limits.turn_jerk_rps3,
        ),
    )
    times = np.arange(0.0, duration + SAMPLE_S, SAMPLE_S)
    linear, angular = brake_velocities(following, limits, times)
    poses = _roll_forward(
        pose.x,
        pose.y,
        pose.yaw_rad,
        motion.twist.linear_mps,
        motion.twist.angular_rps,
        linear,
        angular,
        dt_s,
    )
    return WayToRest(
        poses,
        np.concatenate(([0.0], dt_s + times)),
        np.abs(np.concatenate(([motion.twist.linear_mps], linear))),
    )


def brake_velocities(
    start: MotionState, limits: MotionLimits, times_s: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Linear and angular velocity at ``times_s`` (N,) after the brake began; see :func:`brake_velocity`."""
    linear = brake_velocity(
        start.twist.linear_mps,
        start.linear_acceleration_mps2,
        limits.acceleration_mps2,
        limits.jerk_mps3,
        times_s,
    )
    angular = brake_velocity(
        start.twist.angular_rps,
        start.angular_acceleration_rps2,
        limits.turn_acceleration_rps2,
        limits.turn_jerk_rps3,
        times_s,
    )
    return linear, angular


@njit(cache=True)
def _roll_forward(
    x: float,
    y: float,
    yaw: float,
    v: float,
    w: float,
    linear: NDArray[np.float64],
    angular: NDArray[np.float64],
    dt_s: float,
) -> NDArray[np.float64]:
    """Poses (x, y, yaw) here, after the period ``dt_s``, then every ``SAMPLE_S`` of the brake."""
    out = np.empty((linear.shape[0] + 1, 3))
    out[0, 0], out[0, 1], out[0, 2] = x, y, yaw
    step = dt_s
    for i in range(linear.shape[0]):
        mean_v, mean_w = 0.5 * (v + linear[i]), 0.5 * (w + angular[i])
        x += mean_v * step * np.cos(yaw + 0.5 * mean_w * step)
        y += mean_v * step * np.sin(yaw + 0.5 * mean_w * step)
        yaw += mean_w * step
        v, w = linear[i], angular[i]
        out[i + 1, 0], out[i + 1, 1], out[i + 1, 2] = x, y, yaw
        step = SAMPLE_S
    return out

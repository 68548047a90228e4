"""An image of a camera that leans with its body, as one of a level robot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from explore_bt.levelling.attitude import AttitudeFilter
from explore_bt.types import RgbdFrame

__all__ = ["level_frame"]


def level_frame(frame: RgbdFrame, attitude: AttitudeFilter, base_height_m: float) -> RgbdFrame:
    """The same pixels, the camera placed where it was on a robot whose ``base_link`` is level.

    Args:
        frame: as measured.
        attitude: that has heard the IMU up to the frame's stamp.
        base_height_m: of ``base_link`` above the floor; heights count from there afterwards.
    """
    rotation = attitude.between(np.array([frame.stamp_s]))[0]
    yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    cos, sin = math.cos(yaw), math.sin(yaw)
    tilt = np.eye(4)
    tilt[:3, :3] = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ rotation
    tilt[2, 3] = base_height_m
    return replace(frame, T_base_sensor=tilt @ frame.T_base_sensor)

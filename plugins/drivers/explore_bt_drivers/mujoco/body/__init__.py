"""The balancing robot's body: what it is made of, what keeps it upright."""

from explore_bt_drivers.mujoco.body.body import Body, Stance
from explore_bt_drivers.mujoco.body.build import (
    BODY_HEIGHT_M,
    BODY_RADIUS_M,
    TRACK_M,
    WHEEL_RADIUS_M,
    Joints,
    add_robot,
)
from explore_bt_drivers.mujoco.body.foresight import FORESIGHT_S
from explore_bt_drivers.mujoco.body.posture import pitch_of

__all__ = [
    "BODY_HEIGHT_M",
    "BODY_RADIUS_M",
    "FORESIGHT_S",
    "TRACK_M",
    "WHEEL_RADIUS_M",
    "Body",
    "Joints",
    "Stance",
    "add_robot",
    "pitch_of",
]

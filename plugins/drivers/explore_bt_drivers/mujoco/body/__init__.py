"""The balancing robot's body: what it is made of, what keeps it upright."""

from explore_bt_drivers.mujoco.body.body import Body, Stance
from explore_bt_drivers.mujoco.body.build import Joints, add_robot
from explore_bt_drivers.mujoco.body.posture import pitch_of

__all__ = ["Body", "Joints", "Stance", "add_robot", "pitch_of"]

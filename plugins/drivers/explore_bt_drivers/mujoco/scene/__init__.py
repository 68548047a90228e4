"""The world as MuJoCo has it: what stands on the floor, and what lidar and camera see of it."""

from explore_bt_drivers.mujoco.scene.groups import GeomGroup

__all__ = ["GeomGroup"]

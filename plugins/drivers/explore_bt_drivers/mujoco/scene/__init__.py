"""The world as MuJoCo has it: what stands on the floor, and what lidar and camera see of it."""

from explore_bt_drivers.mujoco.scene.build import Scene, build_scene
from explore_bt_drivers.mujoco.scene.groups import GeomGroup
from explore_bt_drivers.mujoco.scene.surroundings import Surroundings

__all__ = ["GeomGroup", "Scene", "Surroundings", "build_scene"]

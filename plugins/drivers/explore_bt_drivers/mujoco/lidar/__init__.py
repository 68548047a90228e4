"""A spinning lidar of 16 beams, cast by Embree where it is installed and by MuJoCo where not."""

from explore_bt_drivers.mujoco.lidar.velodyne import VelodyneLike

__all__ = ["VelodyneLike"]

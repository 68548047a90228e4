"""3D sweeps of a body that leans, made level: for maps, and for who drives by a planar scan."""

from explore_bt.levelling.attitude import AttitudeFilter, AttitudeNoise
from explore_bt.levelling.level_cloud import LevelCloud, fault_of_cloud, level
from explore_bt.levelling.level_frame import level_frame
from explore_bt.levelling.virtual_scan import virtual_scan

__all__ = [
    "AttitudeFilter",
    "AttitudeNoise",
    "LevelCloud",
    "fault_of_cloud",
    "level",
    "level_frame",
    "virtual_scan",
]

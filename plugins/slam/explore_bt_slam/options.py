"""Options of the two back ends; defaults were measured, see docs/decisions/slam-settings.md."""

from __future__ import annotations

from pydantic import Field

from explore_bt.interfaces import PluginOptions
from explore_bt.units import Angle, Length

__all__ = ["GroundTruthOptions", "KissGtsamOptions"]


class GroundTruthOptions(PluginOptions):
    """What the map is made of."""

    resolution: Length = Field(0.05, gt=0.0, description="side of a grid cell")
    max_range: Length = Field(5.0, gt=0.0, description="returns beyond are cut off")


class KissGtsamOptions(GroundTruthOptions):
    """What registration and graph are tuned by."""

    keyframe_distance: Length = Field(0.5, gt=0.0, description="a keyframe after driving this far")
    keyframe_angle: Angle = Field(0.5, gt=0.0, description="a keyframe after turning this far")
    match_range: Length = Field(20.0, gt=0.0, description="returns beyond take no part in matching")
    voxel: Length = Field(0.1, gt=0.0, description="cell of kiss-icp's map")
    loop_closures: bool = Field(True, description="close loops from the lidar")
    use_odometry: bool = Field(False, description="trust the wheels for the speed between scans")

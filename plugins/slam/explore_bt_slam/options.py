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
    voxel: Length = Field(0.1, gt=0.0, description="cell of kiss-icp's map")
    loop_closures: bool = Field(True, description="close loops from the lidar")
    base_height: Length = Field(0.0, description="base_link above the floor; the body pitches about it")
    obstacle_band: tuple[Length, Length] = Field(
        (0.1, 1.0),
        description="3D lidar: lower is floor; the second is the robot's height",
    )
    match_band: tuple[Length, Length] = Field(
        (0.3, 2.0), description="3D lidar: heights above the floor that are registered"
    )
    map_top: Length = Field(2.0, gt=0.0, description="3D lidar: what is higher is not kept")
    use_odometry: bool = Field(False, description="trust the wheels for the speed between scans")

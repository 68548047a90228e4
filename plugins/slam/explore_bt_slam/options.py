"""Options of the two back ends; defaults were measured, see docs/decisions/slam-settings.md."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

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
    camera_closures: bool = Field(True, description="close loops from RGB-D images, if there are any")
    base_height: Length | None = Field(
        None,
        description="base_link above the floor; by default as the driver says",
    )
    floor_height: Length = Field(0.1, gt=0.0, description="3D lidar: what is lower counts as floor")
    robot_height: Length | None = Field(
        None, gt=0.0, description="3D lidar: what is higher is passed under; by default as the driver says"
    )
    map_height: Length = Field(2.0, gt=0.0, description="3D lidar: what is higher is not kept")
    match_low: Length = Field(0.3, description="3D lidar: what is lower is not registered")
    match_high: Length = Field(2.0, description="3D lidar: what is higher is not registered")
    clear_start: Length = Field(
        0.0,
        ge=0.0,
        description="3D lidar: floor about the start that is taken for free where nothing is seen on it",
    )
    use_odometry: bool = Field(False, description="trust the wheels for the speed between scans")

    @model_validator(mode="after")
    def _bands_are_bands(self) -> Self:
        for low, high in (
            ("floor_height", "robot_height"),
            ("robot_height", "map_height"),
            ("floor_height", "map_height"),
            ("match_low", "match_high"),
        ):
            if getattr(self, low) is None or getattr(self, high) is None:
                continue
            below, above = float(getattr(self, low)), float(getattr(self, high))
            if below > above or (below == above and high != "map_height"):
                raise ValueError(
                    f"{low} is {below:g} m and {high} {above:g} m; {high} has to be the higher one"
                )
        return self

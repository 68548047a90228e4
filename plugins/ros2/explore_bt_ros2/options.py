"""Options of the ROS 2 driver: names, QoS and frames with the defaults of REP-105 and Nav2."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from explore_bt.interfaces import PluginOptions
from explore_bt.types import BodyShape, MotionLimits
from explore_bt.units import (
    Acceleration,
    AngularAcceleration,
    AngularJerk,
    AngularRate,
    Duration,
    FilePath,
    Jerk,
    Length,
    Speed,
)

__all__ = ["Ros2Options"]


class Ros2Options(PluginOptions):
    """Where a robot's sensors and wheels are on ROS 2; a topic's name may be empty: there is none."""

    parameters: FilePath | None = Field(
        None, description="a file of ros__parameters, Nav2's for example; what is given here counts more"
    )
    namespace: str = Field("", description="before every relative topic name")
    domain: int | None = Field(None, ge=0, le=232, description="ROS domain; none: ROS_DOMAIN_ID, else 0")
    discovery: Literal["localhost", "subnet", "system_default", "off"] = Field(
        "localhost", description="how far nodes are looked for; ROS_AUTOMATIC_DISCOVERY_RANGE counts more"
    )
    use_sim_time: bool = Field(False, description="time is what /clock says")

    scan_topic: str = Field("scan", description="LaserScan")
    cloud_topic: str = Field("", description="PointCloud2, with a time field per point if possible")
    cloud_range: Length | None = Field(
        None, gt=0.0, description="farther away a 3D lidar sees nothing; none: what the clouds show"
    )
    imu_topic: str = Field("imu", description="Imu")
    odom_topic: str = Field("odom", description="Odometry; empty: tf from odom_frame to base_frame")
    colour_topic: str = Field("", description="Image, its CameraInfo beside it")
    depth_topic: str = Field("", description="Image of depth, registered to colour")
    battery_topic: str = Field("battery_state", description="BatteryState")
    emergency_topic: str = Field("emergency_stop", description="Bool; true holds the robot")
    tf_topic: str = Field(
        "/tf",
        description="TFMessage; those that stay are on the same name with _static; tf: in the namespace",
    )
    command_topic: str = Field("cmd_vel", description="where commands go")
    stamped: bool = Field(False, description="commands are TwistStamped, as Nav2's may be")
    reliability: Literal["best_effort", "reliable"] = Field(
        "best_effort", description="asked of the sensors' topics; best_effort hears both kinds"
    )

    base_frame: str = Field("base_link", description="the robot's own frame")
    odom_frame: str = Field("odom", description="where wheel odometry lives")
    map_frame: str = Field("map", description="the frame that the map is published in")

    radius: Length = Field(0.25, ge=0.05, le=2.0, description="radius of the circular footprint")
    height: Length = Field(1.0, ge=0.05, le=5.0, description="of the whole body, where the lidar is a 3D one")
    step: Length = Field(0.05, ge=0.0, le=0.5, description="what is lower is driven over, there")
    base_height: Length = Field(0.0, ge=0.0, le=2.0, description="of base_frame above the floor, there")
    speed: Speed = Field(0.5, ge=0.01, le=5.0, description="largest speed of the body")
    acceleration: Acceleration = Field(0.5, ge=0.01, le=20.0, description="largest acceleration")
    jerk: Jerk = Field(2.0, ge=0.01, le=500.0, description="largest jerk")
    turn_rate: AngularRate = Field(1.2, ge=0.01, le=20.0, description="largest turn rate")
    turn_acceleration: AngularAcceleration = Field(2.0, ge=0.01, le=100.0, description="its largest change")
    turn_jerk: AngularJerk = Field(8.0, ge=0.01, le=2000.0, description="the largest change of that")
    command_delay: Duration = Field(
        0.05, ge=0.0, le=1.0, description="how long the body lags behind its commands"
    )

    silence: Duration = Field(
        0.22, gt=0.0, le=2.0, description="a topic silent for so long stops the robot; 2.2 turns of the lidar"
    )
    outputs: bool = Field(True, description="publish map, path, marks, diagnostics; offer the services")
    start_when_asked: bool = Field(False, description="begin when someone calls the service explore")

    @property
    def shape(self) -> BodyShape:
        """What passes under and over what."""
        return BodyShape(self.height, self.step, self.base_height)

    @property
    def limits(self) -> MotionLimits:
        """The limits of motion as one value."""
        return MotionLimits.of(self)

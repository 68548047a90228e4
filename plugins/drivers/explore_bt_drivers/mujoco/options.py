"""Options of the physical simulator."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from explore_bt.interfaces import PluginOptions
from explore_bt.types import MotionLimits
from explore_bt.units import (
    Acceleration,
    AngularAcceleration,
    AngularJerk,
    AngularRate,
    Duration,
    FilePath,
    Frequency,
    Jerk,
    Length,
    Speed,
)
from explore_bt_drivers.mujoco.figures import BODY_RADIUS_M

__all__ = ["MujocoOptions"]

Place = Annotated[tuple[Length, Length, Length], "x ahead, y left, z up from base_link"]

_NOT_HERE = {
    "beams": "this lidar has columns of 16: say columns",
    "slip_rate": "the wheels slip when they slip: leave it out",
}


class MujocoOptions(PluginOptions):
    """A balancing robot with VLP-16, IMU, RGB-D camera and encoders; noise is one standard deviation."""

    world: FilePath = Field(description="explore-bt world (YAML) or ROS map_server map (YAML)")
    radius: Length = Field(
        0.27, ge=0.05, le=2.0, description="circle that is kept clear; the body itself needs 0.27 m of it"
    )

    lidar_range: Length = Field(5.0, ge=0.2, le=100.0, description="beyond it the lidar sees nothing")
    lidar_rate: Frequency = Field(10.0, ge=0.5, le=20.0, description="turns of the lidar per second")
    columns: int = Field(900, ge=90, le=3600, description="columns per turn, of 16 beams each")
    range_noise: Length = Field(0.02, ge=0.0, le=1.0, description="noise of a range")
    dropout: float = Field(0.002, ge=0.0, le=1.0, description="share of beams that come back invalid")
    lidar_blocked: float = Field(0.0, ge=0.0, le=1.0, description="share of the turn that is covered, astern")
    lidar_mount: Place = Field((0.0, 0.0, 0.5), description="x, y, z of the lidar from base_link")

    camera: Literal["off", "320x240", "640x480"] = Field("off", description="size of the RGB-D images")
    camera_rate: Frequency = Field(5.0, ge=0.1, le=30.0, description="images per second")
    camera_range: Length = Field(6.0, ge=0.5, le=20.0, description="beyond it there is no depth")
    depth_noise: float = Field(
        0.0025, ge=0.0, le=0.1, description="noise of a depth at 1 m, in metres; times its square"
    )
    camera_mount: Place = Field((0.05, 0.0, 0.4), description="x, y, z of the camera from base_link")

    imu_rate: Frequency = Field(250.0, ge=10.0, le=500.0, description="samples of the IMU per second")
    gyro_noise: AngularRate = Field(0.003, ge=0.0, le=1.0, description="noise of a gyroscope sample")
    gyro_bias: AngularRate = Field(0.005, ge=0.0, le=1.0, description="spread of its constant bias")
    accel_noise: Acceleration = Field(0.05, ge=0.0, le=10.0, description="noise of an accelerometer sample")
    accel_bias: Acceleration = Field(0.02, ge=0.0, le=1.0, description="spread of its constant bias")

    odometry_rate: Frequency = Field(20.0, ge=1.0, le=250.0, description="wheel odometry per second")
    odometry_noise: float = Field(0.01, ge=0.0, le=1.0, description="noise of a wheel, share of its motion")
    odometry_scale: float = Field(0.01, ge=0.0, le=0.5, description="spread of a wheel's radius")

    speed: Speed = Field(0.5, ge=0.01, le=0.8, description="largest speed")
    acceleration: Acceleration = Field(0.5, ge=0.01, le=0.8, description="largest acceleration")
    jerk: Jerk = Field(1.5, ge=0.01, le=3.0, description="largest jerk")
    turn_rate: AngularRate = Field(1.2, ge=0.01, le=1.5, description="largest turn rate")
    turn_acceleration: AngularAcceleration = Field(2.0, ge=0.01, le=4.0, description="its largest change")
    turn_jerk: AngularJerk = Field(8.0, ge=0.01, le=40.0, description="the largest change of that")

    walkers: int = Field(0, ge=0, le=20, description="people who walk about at random and heed nobody")
    walker_speed: Speed = Field(1.2, ge=0.01, le=5.0, description="their speed")
    walker_radius: Length = Field(0.25, ge=0.05, le=1.0, description="radius of each, who is a post")

    battery_life: Duration | None = Field(
        None, gt=0, description="a full battery lasts so long; none by default"
    )

    noise: bool = Field(True, description="false: every sensor is exact and no beam drops out")

    @model_validator(mode="before")
    @classmethod
    def _is_meant_here(cls, given: Any) -> Any:
        """Options of ``sim2d`` that mean nothing to this robot are told apart from slips of the pen."""
        if isinstance(given, dict):
            for name in given.keys() & _NOT_HERE.keys():
                raise ValueError(f"{name} is of sim2d; {_NOT_HERE[name]}")
        return given

    @property
    def footprint_m(self) -> float:
        """Radius that is kept clear."""
        return max(self.radius, BODY_RADIUS_M)

    @property
    def limits(self) -> MotionLimits:
        """The limits of motion as one value."""
        return MotionLimits.of(self)

    @property
    def image_size(self) -> tuple[int, int] | None:
        """Width and height of an image, pixels; None without a camera."""
        if self.camera == "off":
            return None
        width, height = self.camera.split("x")
        return int(width), int(height)

"""Options of the planar simulator."""

from __future__ import annotations

from pydantic import Field

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
    PoseTriple,
    Speed,
)

__all__ = ["Sim2dOptions"]


class Sim2dOptions(PluginOptions):
    """A round robot with lidar, IMU and wheels; noise figures are one standard deviation."""

    world: FilePath = Field(description="explore-bt world (YAML) or ROS map_server map (YAML)")
    stand: PoseTriple | None = Field(
        None, description="where the robot really stands, if its start is unknown or shall be wrong"
    )
    radius: Length = Field(0.25, ge=0.05, le=2.0, description="radius of the circular footprint")

    beams: int = Field(360, ge=1, le=2000, description="lidar beams per turn; 360 to 720 are usual")
    lidar_range: Length = Field(5.0, ge=0.2, le=100.0, description="beyond it the lidar sees nothing")
    lidar_rate: Frequency = Field(10.0, ge=0.5, le=50.0, description="turns of the lidar per second")
    range_noise: Length = Field(0.01, ge=0.0, le=1.0, description="noise of a range")
    dropout: float = Field(0.002, ge=0.0, le=1.0, description="share of beams that come back invalid")

    imu_rate: Frequency = Field(100.0, ge=1.0, le=1000.0, description="samples of the IMU per second")
    gyro_noise: AngularRate = Field(0.002, ge=0.0, le=1.0, description="noise of a gyroscope sample")
    gyro_bias: AngularRate = Field(0.002, ge=0.0, le=1.0, description="spread of its constant bias")
    accel_noise: Acceleration = Field(0.02, ge=0.0, le=10.0, description="noise of an accelerometer sample")

    odometry_rate: Frequency = Field(20.0, ge=1.0, le=200.0, description="wheel odometry per second")
    odometry_noise: float = Field(0.02, ge=0.0, le=1.0, description="noise of the wheels, share of a motion")
    odometry_scale: float = Field(0.02, ge=0.0, le=0.5, description="spread of the wheels' constant error")
    slip_rate: Frequency = Field(0.05, ge=0.0, le=10.0, description="how often a wheel slips for 0.5 s")

    speed: Speed = Field(0.5, ge=0.01, le=5.0, description="largest speed")
    acceleration: Acceleration = Field(0.5, ge=0.01, le=20.0, description="largest acceleration")
    jerk: Jerk = Field(2.0, ge=0.01, le=500.0, description="largest jerk")
    turn_rate: AngularRate = Field(1.2, ge=0.01, le=20.0, description="largest turn rate")
    turn_acceleration: AngularAcceleration = Field(2.0, ge=0.01, le=100.0, description="its largest change")
    turn_jerk: AngularJerk = Field(8.0, ge=0.01, le=2000.0, description="the largest change of that")

    walkers: int = Field(0, ge=0, le=20, description="people who walk about at random and heed nobody")
    walker_speed: Speed = Field(1.2, ge=0.01, le=5.0, description="their speed")
    walker_radius: Length = Field(0.25, ge=0.05, le=1.0, description="radius of each, who is a disc")

    battery_life: Duration | None = Field(
        None, gt=0, description="a full battery lasts so long; none by default"
    )

    noise: bool = Field(True, description="false: every sensor is exact, no beam drops out, no wheel slips")

    @property
    def limits(self) -> MotionLimits:
        """The limits of motion as one value."""
        return MotionLimits.of(self)

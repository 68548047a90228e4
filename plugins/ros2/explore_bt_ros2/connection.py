"""What the ROS 2 driver shares with the plugins of its family."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt_ros2.clock import RosClock
from explore_bt_ros2.link import Link
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.transforms import TransformBuffer

__all__ = ["Connection"]


@dataclass(frozen=True, slots=True)
class Connection:
    """One node, one clock, one tf buffer for driver, SLAM, controller and outputs of a robot."""

    link: Link
    clock: RosClock
    buffer: TransformBuffer
    options: Ros2Options

"""The plugins of this family; they are left out where ROS 2 is not installed."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import hookimpl
from explore_bt.plugin import require

_OTHERWISE = ", or source /opt/ros/jazzy/setup.bash before"
require("rclpy", "ros2", otherwise=_OTHERWISE)

__all__ = ["explore_bt_register"]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """Driver, SLAM, controller and bridge."""
    require("rclpy", "ros2", otherwise=_OTHERWISE)
    from explore_bt_ros2.driver import Ros2
    from explore_bt_ros2.nav2 import Nav2
    from explore_bt_ros2.neighbour_map import Ros2Map
    from explore_bt_ros2.trial import Ros2Bridge

    return [Ros2, Ros2Map, Nav2, Ros2Bridge]

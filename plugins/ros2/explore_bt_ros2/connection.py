"""What the ROS 2 driver shares with the plugins of its family."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

from explore_bt_ros2.clock import RosClock
from explore_bt_ros2.link import Link
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.transforms import TransformBuffer

__all__ = ["Connection"]


@dataclass(frozen=True, slots=True)
class Connection:
    """One node, one clock, one tf buffer for driver, SLAM, controller and outputs of a robot.

    Attributes:
        has_neighbour_map: set where somebody else's SLAM makes the map: then ours publishes none.
    """

    link: Link
    clock: RosClock
    buffer: TransformBuffer
    options: Ros2Options
    has_neighbour_map: threading.Event = field(default_factory=threading.Event)

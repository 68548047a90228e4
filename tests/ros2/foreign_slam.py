"""A stand-in for the SLAM that runs on a robot: as a script it publishes map and tf, nothing else.

It makes its map with our own SLAM, but what others see of it is /map and map → odom alone.
"""

from __future__ import annotations

import math
import signal
import sys
import threading
from typing import Any

import numpy as np
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.grids import grid_message
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.stamps import stamp_message
from explore_bt_ros2.transforms import Transform, encode
from explore_bt_slam import KissGtsam
from nav_msgs.msg import OccupancyGrid as GridMessage
from rclpy.qos import DurabilityPolicy, QoSProfile

from explore_bt.interfaces import RobotContext

_MAP_PERIOD_S = 0.5


class ForeignSlam:
    """Hears the robot, publishes what a SLAM on it would."""

    def __init__(self) -> None:
        self._driver = Ros2(Ros2Options(use_sim_time=True, outputs=False, command_topic="nobody"))
        self._driver.setup(RobotContext())
        self._slam = KissGtsam(KissGtsam.Options())
        self._slam.setup(RobotContext())
        link = self._driver.connection.link
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._map = link.publisher(GridMessage, "map", kept)
        self._tf = link.publisher(link.tf_type, "/tf", QoSProfile(depth=100))
        self._map_due_s = -math.inf
        self._revision = -1

    def run(self, ended: threading.Event) -> None:
        """At 20 Hz of its clock, until the end."""
        clock = self._driver.clock
        print("foreign SLAM runs", flush=True)  # noqa: T201  # what the test waits for
        while not ended.is_set():
            clock.wait_until(clock.now_s() + 0.05)
            for measured in self._driver.read():
                self._slam.update(measured)
            self._publish_tf()
            if clock.now_s() >= self._map_due_s:
                self._map_due_s = clock.now_s() + _MAP_PERIOD_S
                self._publish_map()
        self._driver.close()

    def _publish_tf(self) -> None:
        clock, buffer = self._driver.clock, self._driver.connection.buffer
        estimate = self._slam.estimate()
        ros_s = clock.stamp_s(estimate.stamp_s)
        T_odom_base = buffer.find("odom", "base_link", ros_s)
        if T_odom_base is None:
            return
        T_map_base = Transform.planar(ros_s, "map", "base_link", estimate.T_map_base).matrix()
        T = T_map_base @ np.linalg.inv(T_odom_base)
        self._tf.publish(encode([Transform.of_matrix(ros_s, "map", "odom", T)]))

    def _publish_map(self) -> None:
        grid = self._slam.grid()
        if grid.revision == self._revision:
            return
        self._revision = grid.revision
        message: Any = GridMessage()
        message.header.frame_id = "map"
        message.header.stamp = stamp_message(self._driver.clock.ros_s())
        self._map.publish(grid_message(message, grid))


if __name__ == "__main__":
    over = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: over.set())
    ForeignSlam().run(over)
    sys.exit(0)

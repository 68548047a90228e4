"""A lidar's node, to be killed: passes ``real/scan`` on as ``scan``; its word may be ``best_effort``."""

from __future__ import annotations

import sys

import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan


def main() -> None:
    """Until it is killed."""
    rclpy.init()
    node = rclpy.create_node("lidar")
    best_effort = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    offered = best_effort if "best_effort" in sys.argv else QoSProfile(depth=10)
    scans = node.create_publisher(LaserScan, "scan", offered)
    node.create_subscription(LaserScan, "real/scan", scans.publish, best_effort, raw=True)
    print("lidar runs", flush=True)  # noqa: T201  # what the test waits for
    rclpy.spin(node)


if __name__ == "__main__":
    main()

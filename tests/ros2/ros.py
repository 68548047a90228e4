"""Skips a test file where ROS 2 is not installed; imported first by each."""

import pytest

pytest.importorskip(
    "rclpy", reason='ROS 2 is not installed here: make test-ros2, or pip install "explore-bt[ros2]"'
)

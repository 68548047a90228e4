"""A simulated robot behind ROS 2 topics, as a real one would look."""

from explore_bt_ros2.trial.bridge import Ros2Bridge, Ros2BridgeOptions

__all__ = ["Ros2Bridge", "Ros2BridgeOptions"]

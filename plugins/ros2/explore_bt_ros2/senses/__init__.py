"""From topics to measurements."""

from explore_bt_ros2.senses.senses import Senses
from explore_bt_ros2.senses.topic import Topic

__all__ = ["Senses", "Topic"]

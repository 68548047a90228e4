"""``/tf`` without tf2, which is not on the package index: the message, a buffer, look-ups."""

from explore_bt_ros2.transforms.buffer import TransformBuffer
from explore_bt_ros2.transforms.message import decode, encode
from explore_bt_ros2.transforms.message_type import tf_message_type
from explore_bt_ros2.transforms.transform import Transform

__all__ = ["Transform", "TransformBuffer", "decode", "encode", "tf_message_type"]

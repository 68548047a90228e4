"""What ROS messages mean: bags and live topics are understood by the same code. No ROS is needed.

A message is any object with the fields of its definition; what does not fit raises ``ValueError`` in words.
"""

from explore_bt.ros_messages.camera import CAMERA_INFO, IMAGE, CameraStream, CameraTopics, choose_camera
from explore_bt.ros_messages.image_pairs import ImagePairs
from explore_bt.ros_messages.messages import MESSAGES, TRANSFORMS, stamp_of
from explore_bt.ros_messages.mountings import Mountings, Places, link_of, planar, rotation_of

__all__ = [
    "CAMERA_INFO",
    "IMAGE",
    "MESSAGES",
    "TRANSFORMS",
    "CameraStream",
    "CameraTopics",
    "ImagePairs",
    "Mountings",
    "Places",
    "choose_camera",
    "link_of",
    "planar",
    "rotation_of",
    "stamp_of",
]

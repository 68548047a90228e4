"""Map files: ROS map_server, and YAML read with its places."""

from explore_bt.maps.map_server import read_map, write_map
from explore_bt.maps.marked_yaml import MarkedFile

__all__ = ["MarkedFile", "read_map", "write_map"]

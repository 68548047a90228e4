"""Which geoms the sensors see: MuJoCo's geom groups, by name."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["GeomGroup"]


class GeomGroup(IntEnum):
    """What a geom is to lidar and camera; all of them collide."""

    WORLD = 0
    """Seen by both."""
    GLASS = 1
    """The lidar passes through, the camera sees it."""
    MIRROR = 2
    """The lidar is reflected."""
    ROBOT = 3
    """The robot itself: seen by neither."""
    UNSEEN = 4
    """Helps to collide, seen by neither."""

"""A recording as a video: the map with the robots on it, the tree with its statuses, a timeline."""

from explore_bt.export.video.film import film
from explore_bt.export.video.writer import write_video

__all__ = ["film", "write_video"]

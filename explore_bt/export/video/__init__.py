"""Videos: of a recording, with map, tree and timeline; of a simulated world, while the run goes on."""

from explore_bt.export.video.film import film
from explore_bt.export.video.live import LiveFilm
from explore_bt.export.video.mp4 import Mp4Writer
from explore_bt.export.video.writer import write_video

__all__ = ["LiveFilm", "Mp4Writer", "film", "write_video"]

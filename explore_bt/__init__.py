"""explore-bt: missions for indoor exploration robots, as behaviour trees over swappable plugins."""

from explore_bt.plugin.spec import hookimpl
from explore_bt.version import __version__

__all__ = ["__version__", "hookimpl"]

"""explore-bt: missions for indoor exploration robots, as behaviour trees over swappable plugins."""

from explore_bt.plugin.spec import hookimpl

__all__ = ["__version__", "hookimpl"]

__version__ = "0.1.0"

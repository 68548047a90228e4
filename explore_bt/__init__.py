"""explore-bt: missions for indoor exploration robots, as behaviour trees over swappable plugins.

``Explorer`` gives the strategies to foreign loops: a map and a pose in, the next goal and path out. It
brings the whole framework along, so it is imported on first use only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from explore_bt.plugin.spec import hookimpl
from explore_bt.version import __version__

if TYPE_CHECKING:
    from explore_bt.headless import Decision, Explorer

__all__ = ["Decision", "Explorer", "__version__", "hookimpl"]


def __getattr__(name: str) -> object:
    if name not in ("Decision", "Explorer"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from explore_bt import headless

    return getattr(headless, name)

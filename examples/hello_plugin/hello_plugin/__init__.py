"""An outside distribution: what it registers is all that explore-bt needs to know of it."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import hookimpl
from hello_plugin.greeting import Hello
from hello_plugin.visitors import VisitorsBook

__all__ = ["Hello", "VisitorsBook", "explore_bt_register"]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """The classes of this distribution."""
    return [Hello, VisitorsBook]

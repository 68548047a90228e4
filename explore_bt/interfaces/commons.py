"""What the plugins of one mission have in common."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

__all__ = ["Commons"]

T = TypeVar("T")


class Commons:
    """Things that the robots of one mission share within one process: a simulated world, a radio.

    Made anew for every run, so that two runs in one process never meet. A key begins with the plugin's own
    name, so that two plugins do not meet either.
    """

    def __init__(self) -> None:
        self._things: dict[Hashable, Any] = {}

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """The thing of that key; whoever asks first makes it."""
        if key not in self._things:
            self._things[key] = make()
        found: T = self._things[key]
        return found

"""Which depth image belongs to which colour image."""

from __future__ import annotations

from collections import deque
from typing import Generic, TypeVar

__all__ = ["ImagePairs"]

_APART_S = 0.02
_WAITING = 10

T = TypeVar("T")


class ImagePairs(Generic[T]):
    """Two streams of stamped images in, pairs that are at most 20 ms apart out.

    An image waits for its partner while no more than ten of its kind wait; an older one, or one that a later
    pair has overtaken, goes without.
    """

    def __init__(self) -> None:
        self._waiting: tuple[deque[tuple[float, T]], deque[tuple[float, T]]] = (deque(), deque())
        self.alone = 0

    def take(self, which: int, stamp_s: float, image: T) -> tuple[T, T] | None:
        """An image of stream 0 (colour) or 1 (depth); the pair in this order, if there is one now."""
        mine, others = self._waiting[which], self._waiting[1 - which]
        nearest = min(others, key=lambda other: abs(other[0] - stamp_s), default=None)
        if nearest is None or not abs(nearest[0] - stamp_s) <= _APART_S:
            mine.append((stamp_s, image))
            if len(mine) > _WAITING:
                mine.popleft()
                self.alone += 1
            return None
        while others[0] is not nearest:
            others.popleft()
            self.alone += 1
        others.popleft()
        self.alone += len(mine)
        mine.clear()
        return (image, nearest[1]) if which == 0 else (nearest[1], image)

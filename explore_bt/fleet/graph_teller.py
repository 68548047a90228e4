"""What of a robot's pose graph has to be told, and has not been."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from explore_bt.interfaces import GraphShare
from explore_bt.types import STRETCH_KEYFRAMES, SharedKeyframe, SharedStretch

__all__ = ["GraphTeller"]

_MOVED_M = 0.01
_MOVED_RAD = 0.003


class GraphTeller:
    """Every keyframe once; a stretch again when it has grown, moved, or was measured otherwise."""

    def __init__(self, share: GraphShare) -> None:
        self._share = share
        self._keyframes = 0
        self._stretches: dict[int, SharedStretch] = {}

    def fresh(self) -> Iterator[SharedKeyframe | SharedStretch]:
        """What has come up since the last call."""
        count = self._share.keyframe_count()
        if count < self._keyframes:  # a map was loaded: another graph
            self._keyframes, self._stretches = 0, {}
        for number in range(self._keyframes, count):
            yield self._share.keyframe(number)
        self._keyframes = count
        for number in range(math.ceil(count / STRETCH_KEYFRAMES)):
            now, told = self._share.stretch(number), self._stretches.get(number)
            if told is None or _differs(told, now):
                self._stretches[number] = now
                yield now


def _differs(told: SharedStretch, now: SharedStretch) -> bool:
    if len(told.poses) != len(now.poses) or len(told.edges) != len(now.edges):
        return True
    both = zip(told.edges, now.edges, strict=True)
    if any((a.a, a.b, a.relative) != (b.a, b.b, b.relative) for a, b in both):
        return True
    off = np.abs(now.poses - told.poses)
    return bool(off[:, :2].max(initial=0.0) > _MOVED_M or off[:, 2].max(initial=0.0) > _MOVED_RAD)

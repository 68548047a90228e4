"""The transforms heard lately, and what lies between them."""

from __future__ import annotations

import threading
from bisect import bisect_left
from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from explore_bt_ros2.transforms.transform import Transform

__all__ = ["TransformBuffer"]

_MEMORY_S = 10.0
_NEWEST = float("inf")


class TransformBuffer:
    """Takes transforms in the ROS thread, answers in any other.

    Between two stamps it interpolates (a straight line, and the shorter turn); beyond the newest it gives the
    newest, and ``newest_s`` tells how old that is.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._fixed: dict[str, Transform] = {}
        self._moving: dict[str, deque[Transform]] = {}

    def learn_fixed(self, transforms: Iterable[Transform]) -> None:
        """From ``/tf_static``."""
        with self._lock:
            self._fixed |= {each.child: each for each in transforms}

    def learn(self, transforms: Iterable[Transform]) -> None:
        """From ``/tf``; stamps that go back by more than the memory begin the memory anew."""
        with self._lock:
            for each in transforms:
                heard = self._moving.setdefault(each.child, deque())
                if heard and (
                    each.parent != heard[-1].parent or each.stamp_s < heard[-1].stamp_s - _MEMORY_S
                ):
                    heard.clear()
                if heard and each.stamp_s <= heard[-1].stamp_s:
                    continue  # said again, or by a second speaker
                heard.append(each)
                while heard[0].stamp_s < each.stamp_s - _MEMORY_S:
                    heard.popleft()

    def frames(self) -> tuple[str, ...]:
        """Every frame that has a place in another, sorted."""
        with self._lock:
            return tuple(sorted({*self._fixed, *self._moving}))

    def find(self, parent: str, child: str, stamp_s: float = _NEWEST) -> NDArray[np.float64] | None:
        """(4, 4) float64 ``T_parent_child`` at a time of the ROS clock; None where nothing ties them.

        ``parent`` need not be above ``child``: the two have to hang in one tree.
        """
        with self._lock:
            below = self._way_up(_plain(child), stamp_s)
            above = self._way_up(_plain(parent), stamp_s)
        common = next((frame for frame in below if frame in above), None)
        if common is None:
            return None
        T: NDArray[np.float64] = np.linalg.inv(above[common]) @ below[common]
        return T

    def newest_s(self, parent: str, child: str) -> float | None:
        """Stamp of the stalest moving link between the two; inf if all is fixed, None if untied."""
        with self._lock:
            below, above = self._chain(_plain(child)), self._chain(_plain(parent))
            common = next((frame for frame in below if frame in above), None)
            if common is None:
                return None
            links = [*below[: below.index(common)], *above[: above.index(common)]]
            stamps_s = [self._moving[link][-1].stamp_s for link in links if link not in self._fixed]
            return min(stamps_s, default=_NEWEST)

    def meeting(self, one: str, other: str) -> str | None:
        """The lowest frame above both, or one of them; None if they hang in no common tree."""
        with self._lock:
            above = self._chain(_plain(other))
            return next((frame for frame in self._chain(_plain(one)) if frame in above), None)

    def _way_up(self, frame: str, stamp_s: float) -> dict[str, NDArray[np.float64]]:
        """Frame -> (4, 4) ``T_frame_start``, from the start upwards."""
        T = np.eye(4)
        way = {frame: T}
        while (link := self._link(frame, stamp_s)) is not None and link.parent not in way:
            T = link.matrix() @ T
            frame = link.parent
            way[frame] = T
        return way

    def _chain(self, frame: str) -> list[str]:
        """The frame and those above it."""
        chain = [frame]
        while (link := self._link(chain[-1], _NEWEST)) is not None and link.parent not in chain:
            chain.append(link.parent)
        return chain

    def _link(self, child: str, stamp_s: float) -> Transform | None:
        fixed = self._fixed.get(child)
        if fixed is not None:
            return fixed
        heard = self._moving.get(child)
        return _at(heard, stamp_s) if heard else None


def _at(heard: deque[Transform], stamp_s: float) -> Transform:
    if stamp_s >= heard[-1].stamp_s:
        return heard[-1]
    index = bisect_left(heard, stamp_s, key=lambda each: each.stamp_s)
    if index == 0:
        return heard[0]
    before, after = heard[index - 1], heard[index]
    share = (stamp_s - before.stamp_s) / (after.stamp_s - before.stamp_s)
    shift = np.array(before.shift) + share * (np.array(after.shift) - np.array(before.shift))
    x, y, z = shift.tolist()
    return Transform(stamp_s, after.parent, after.child, (x, y, z), _turned(before.turn, after.turn, share))


def _turned(
    before: tuple[float, ...], after: tuple[float, ...], share: float
) -> tuple[float, float, float, float]:
    """Spherical interpolation the shorter way round."""
    a, b = np.array(before), np.array(after)
    cosine = float(a @ b)
    if cosine < 0.0:
        b, cosine = -b, -cosine
    angle = float(np.arccos(min(cosine, 1.0)))
    if angle > 1e-4:
        a, b = a * np.sin((1.0 - share) * angle), b * np.sin(share * angle)
    else:
        a, b = a * (1.0 - share), b * share
    mixed = a + b
    x, y, z, w = (mixed / np.linalg.norm(mixed)).tolist()
    return (x, y, z, w)


def _plain(frame: str) -> str:
    return frame.lstrip("/")

"""Where in the map a robot is that does not know: set down elsewhere, or woken in a saved map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, wrap_angle
from explore_bt_slam.far_closures import FarClosureFinder, Sighting
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import one_every

__all__ = ["Relocaliser"]

_PLACES_PER_SCAN = 8
_SPACING_M = 2.0
_SAME_M = 0.3
_SAME_RAD = 0.1


@dataclass(slots=True)
class _Search:
    """One scan on its way through all places; ``believed`` is where dead reckoning had it."""

    scan: Keyframe
    believed: Pose2
    places: list[int]
    sightings: list[Sighting] = field(default_factory=list)


class Relocaliser:
    """Lays a scan onto every place in turn, a few with each call, and believes the second like answer.

    Args:
        finder: matches pieces with places.
    """

    def __init__(self, finder: FarClosureFinder) -> None:
        self._finder = finder
        self._search: _Search | None = None
        self._first: tuple[Pose2, Pose2] | None = None

    def forget(self) -> None:
        """The robot knows where it is."""
        self._search, self._first = None, None

    def step(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], scan: Keyframe, believed: Pose2
    ) -> tuple[int, Pose2] | None:
        """Go on searching; the nearest keyframe and ``T_map_base`` now, once two scans agree.

        Args:
            keyframes: all of them.
            poses: (N, 3) float64, theirs.
            scan: what is seen now.
            believed: where dead reckoning puts the robot now; only its changes count.
        """
        if self._search is None:
            self._search = _Search(scan, believed, one_every(keyframes, _SPACING_M))
        search = self._search
        now, search.places = search.places[:_PLACES_PER_SCAN], search.places[_PLACES_PER_SCAN:]
        turns = dict.fromkeys(now, np.pi)
        search.sightings += self._finder.sightings(keyframes, poses, search.scan.points, 0.0, turns)
        if search.places:
            return None
        self._search = None
        edge = self._finder.recognised(keyframes, poses, search.scan, search.sightings)
        if edge is None:
            self._first = None
            return None
        place, seen = edge
        first, self._first = self._first, (search.believed, seen)
        if first is None or not _same(first[1].compose(first[0].between(search.believed)), seen):
            return None
        self.forget()
        return place, seen.compose(search.believed.between(believed))


def _same(one: Pose2, other: Pose2) -> bool:
    return one.distance_to(other) <= _SAME_M and abs(wrap_angle(one.yaw_rad - other.yaw_rad)) <= _SAME_RAD

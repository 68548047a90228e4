"""Where in a team mate's map a robot is, if nobody knows how the two maps lie to each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.far_closures import FarClosureFinder, FarRule, Sighting, unrivalled
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import one_every
from explore_bt_slam.mate_graph import MateGraph
from explore_bt_slam.pose_graph import Edge, closure_edge

__all__ = ["MateSearch"]

_PLACES_PER_STEP = 1
_PLACE_SPACING_M = 2.0
_TRY_SPACING_M = 1.0
_SCORE, _STRETCH_M, _REACH_M = 0.42, 4.0, 8.0
"""Less than for a robot's own loops: what one has seen of a place the other need not have."""
_SAME_M = 0.5
_SAME_RAD = 0.15


@dataclass(slots=True)
class _Walk:
    """One piece on its way over all places of one map."""

    points: NDArray[np.float64]
    places: list[int]
    sightings: list[Sighting] = field(default_factory=list)


class MateSearch:
    """Lays the robot's last metres onto every place of the mate's map, and that place onto its own map.

    Both ways there must be one answer without a rival, and the same: a room that has a twin, in either map,
    is no evidence. A few places are tried with every step.
    """

    def __init__(self) -> None:
        self._rule = FarRule(score=_SCORE, stretch_m=_STRETCH_M, reach_m=_REACH_M)
        self._theirs, self._ours = FarClosureFinder(self._rule), FarClosureFinder(self._rule)
        self._there: _Walk | None = None
        self._back: _Walk | None = None
        self._found: Edge | None = None
        self._number = -1
        self._tried_m = -np.inf

    def step(self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], mate: MateGraph) -> Edge | None:
        """Go on searching; a closure from the mate's keyframe ``a`` to one's own ``b`` when one is found.

        Args:
            keyframes: one's own.
            poses: (N, 3) float64, theirs, own ``map`` frame.
            mate: the other map.
        """
        if self._back is not None:
            return self._step_back(keyframes, poses, self._back)
        if self._there is None:
            newest = len(keyframes) - 1
            if newest < 0 or keyframes[newest].driven_m - self._tried_m < _TRY_SPACING_M:
                return None
            self._tried_m, self._number = keyframes[newest].driven_m, newest
            piece = self._ours.piece(keyframes, poses, newest)
            self._there = _Walk(piece, one_every(mate.keyframes, _PLACE_SPACING_M))
        walk = self._there
        self._lay(walk, self._theirs, mate.keyframes, mate.poses)
        if walk.places:
            return None
        self._there = None
        best = unrivalled(walk.sightings, self._rule.ambiguity)
        if best is None:
            return None
        fitted = self._theirs.fitted(mate.keyframes, mate.poses, keyframes[self._number], best)
        if fitted is None:
            return None
        self._found = closure_edge(mate.poses, best.place, self._number, fitted)
        piece = self._theirs.piece_about(mate.keyframes, mate.poses, best.place)
        self._back = _Walk(piece, one_every(keyframes, _PLACE_SPACING_M))
        return None

    def _step_back(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], walk: _Walk
    ) -> Edge | None:
        """The mate's place in one's own map: only where it was found from, and nowhere else."""
        self._lay(walk, self._ours, keyframes, poses)
        if walk.places:
            return None
        self._back = None
        best = unrivalled(walk.sightings, self._rule.ambiguity)
        found = self._found
        if best is None or found is None:
            return None
        expected = Pose2(*poses[found.b].tolist()).compose(found.relative.inverse())
        off = expected.between(best.pose)
        is_same = np.hypot(off.x, off.y) <= _SAME_M and abs(off.yaw_rad) <= _SAME_RAD
        return found if is_same else None

    def _lay(
        self,
        walk: _Walk,
        finder: FarClosureFinder,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
    ) -> None:
        now, walk.places = walk.places[:_PLACES_PER_STEP], walk.places[_PLACES_PER_STEP:]
        turns = dict.fromkeys(now, np.pi)
        walk.sightings += finder.sightings(keyframes, poses, walk.points, 0.0, turns)

"""``kiss_gtsam`` among team mates: one pose graph over all, in every robot."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import GraphShare
from explore_bt.types import STRETCH_KEYFRAMES, MapFit, Pose2, SharedEdge, SharedKeyframe, SharedStretch
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.mate_bond import MateBond
from explore_bt_slam.pose_graph import Edge

__all__ = ["KissShare"]

_CLOSURES_TOLD = 2
"""Of each keyframe: more would say the same again, and cost the network."""


class KissShare(GraphShare):
    """Tells keyframes and constraints, and takes those of mates into one's own graph.

    Args:
        back: what keeps the keyframes now; another one after a map was loaded.
    """

    can_find = True

    def __init__(self, back: Callable[[], BackEnd]) -> None:
        self._back_now = back
        self._back_of_bonds = back()
        self._bonds: dict[str, MateBond] = {}
        self._edges: dict[int, list[Edge]] = {}
        self._edges_of: NDArray[np.float64] | None = None
        self._turn = 0

    def keyframe_count(self) -> int:
        """How many there are."""
        return len(self._back.keyframes)

    def keyframe(self, number: int) -> SharedKeyframe:
        """What was seen from one."""
        keyframe = self._back.keyframes[number]
        return SharedKeyframe(number, keyframe.stamp_s, keyframe.driven_m, keyframe.points)

    def stretch(self, number: int) -> SharedStretch:
        """Where they are, with at most two closures of each."""
        back = self._back
        if back.poses is not self._edges_of:
            self._edges, self._edges_of = _by_later_end(back.edges), back.poses
        first = number * STRETCH_KEYFRAMES
        poses = back.poses[first : first + STRETCH_KEYFRAMES]
        told = [each for b in range(first, first + len(poses)) for each in _told(self._edges.get(b, []))]
        return SharedStretch(number, poses, tuple(told))

    def take(self, mate: str, told: SharedKeyframe | SharedStretch) -> None:
        """Keep it for ``look``."""
        self._bond(mate).take(told, self._back)

    def expect(self, mate: str, T_ours_theirs: Pose2) -> None:
        """The first closures are sought as the maps are said to lie."""
        self._bond(mate).expect(T_ours_theirs)

    def look(self) -> None:
        """One mate a call."""
        bonds = list(self._bonds.values())
        if bonds:
            self._turn = (self._turn + 1) % len(bonds)
            bonds[self._turn].look(self._back)

    def fit(self, mate: str) -> MapFit | None:
        """See ``GraphShare``."""
        return self._bond(mate).fit(self._back)

    def doubts(self, mate: str) -> bool:
        """See ``GraphShare``."""
        return self._bond(mate).is_doubtful

    def refuse(self, mate: str) -> None:
        """See ``GraphShare``."""
        self._bond(mate).refuse(self._back)

    def why_not(self, mate: str) -> str:
        """How far the search has come."""
        count = self._bond(mate).evidence
        if not count:
            return "no place that both know was found"
        return f"{count} closure{'s' if count > 1 else ''} found, more have to say the same"

    @property
    def _back(self) -> BackEnd:
        back = self._back_now()
        if back is not self._back_of_bonds:  # a map was loaded: nothing is tied to it
            for bond in self._bonds.values():
                bond.let_go(self._back_of_bonds)
            self._back_of_bonds = back
        return back

    def _bond(self, mate: str) -> MateBond:
        if mate not in self._bonds:
            self._bonds[mate] = MateBond(len(self._bonds))
        return self._bonds[mate]


def _by_later_end(edges: Sequence[Edge]) -> dict[int, list[Edge]]:
    found: dict[int, list[Edge]] = defaultdict(list)
    for edge in edges:
        found[max(edge.a, edge.b)].append(edge)
    return found


def _told(edges: list[Edge]) -> list[SharedEdge]:
    steps = [edge for edge in edges if not edge.is_closure]
    closures = [edge for edge in edges if edge.is_closure][:_CLOSURES_TOLD]
    return [
        SharedEdge(edge.a, edge.b, edge.relative, edge.covariance, edge.is_closure)
        for edge in (*steps, *closures)
    ]

"""Loop closures from the camera: known by appearance, placed by depth, believed only with the lidar."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.agreement import Agreement
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.lidar_verdict import confirm
from explore_bt_slam.pose_graph import Edge
from explore_bt_slam.sight import Sight
from explore_bt_slam.sight_match import match_sights
from explore_bt_slam.sight_store import SightStore

__all__ = ["CameraClosures", "CameraRule"]


@dataclass(frozen=True, slots=True)
class CameraRule:
    """What the camera may claim.

    Attributes:
        driven_m: at least this much way lies between the two keyframes.
        known_m: a place whose distance the graph knows this well needs no closure.
        votes: fewer like features are no candidate.
        per_keyframe: at most so many candidates, ``spacing_m`` of way apart.
        rival: another place with this share of the best one's inliers makes both of them doubtful.
        rival_m: closures that put the robot this far apart are rivals.
        same_view_m, same_view_rad: two views from places this close should match.
        together_m: keyframes with less way between them lie rightly to each other.
        rich: a view with fewer features contradicts nothing.
        familiar: with this many inliers the place need not be remembered again.
    """

    driven_m: float = 4.0
    known_m: float = 0.05
    votes: int = 6
    per_keyframe: int = 3
    spacing_m: float = 1.0
    rival: float = 0.6
    rival_m: float = 0.5
    same_view_m: float = 0.35
    same_view_rad: float = 0.25
    together_m: float = 3.0
    rich: int = 60
    familiar: int = 60


@dataclass(frozen=True, slots=True, eq=False)
class _Claim:
    edge: Edge
    inliers: int


class CameraClosures:
    """One sight a keyframe; each new one is compared with the places that look like it.

    A closure is proposed when depth, heights and lidar all agree, no other place claims the same view, and
    a closure of another keyframe says the same about the drift.
    """

    def __init__(self, rule: CameraRule | None = None) -> None:
        self._rule = rule or CameraRule()
        self._store = SightStore()
        self._agreement = Agreement()

    def arrays(self) -> dict[str, NDArray[Any]]:
        """What the camera remembers, for a file."""
        return self._store.arrays()

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Remember what a saved map looked like."""
        self._store.restore(arrays)

    @property
    def is_empty(self) -> bool:
        """Whether no place is remembered yet."""
        return not self._store.sights

    def remember(self, keyframe: int, sight: Sight) -> None:
        """What a keyframe looks like, without asking what else looks like that."""
        self._store.add(keyframe, sight)

    def find(
        self,
        sight: Sight,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        covariances: NDArray[np.float64],
    ) -> list[Edge]:
        """Remember what the newest keyframe looks like; the closures that this confirms.

        Args:
            sight: what was seen from the newest keyframe.
            keyframes: all of them.
            poses: (N, 3) float64, theirs, ``map`` frame.
            covariances: (N, 3, 3) float64 relative to the newest, see ``relative_covariances``.
        """
        claim = self._best_claim(sight, keyframes, poses, covariances)
        edges = self._agreement.of(claim.edge, poses, covariances) if claim else []
        if not (edges and claim and claim.inliers >= self._rule.familiar):
            self.remember(len(keyframes) - 1, sight)
        return edges

    def contradict(
        self,
        sight: Sight,
        closures: Sequence[Edge],
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
    ) -> bool:
        """Whether a closure puts the newest keyframe where all looks different: rooms of one shape.

        Only a view from nearly the same place is compared, and only if both views are rich.
        """
        return any(
            self._looks_different(sight, edge, keyframes, poses)
            for edge in closures
            if edge.b == len(keyframes) - 1
        )

    def _looks_different(
        self, sight: Sight, edge: Edge, keyframes: Sequence[Keyframe], poses: NDArray[np.float64]
    ) -> bool:
        rule, claimed = self._rule, Pose2(*poses[edge.a].tolist()).compose(edge.relative)
        best = self._view_from(claimed, keyframes[edge.a].driven_m, keyframes, poses)
        if best is None or min(self._store.sights[best].points.shape[0], sight.points.shape[0]) < rule.rich:
            return False
        match = match_sights(self._store.sights[best], sight)
        if match is None:
            return True
        seen = Pose2(*poses[self._store.keyframes[best]].tolist()).compose(match.relative)
        return seen.distance_to(claimed) > rule.rival_m

    def _view_from(
        self, place: Pose2, driven_m: float, keyframes: Sequence[Keyframe], poses: NDArray[np.float64]
    ) -> int | None:
        """The number of the remembered sight taken nearest to a place, on the same stretch of way."""
        rule, owners = self._rule, np.array(self._store.keyframes, dtype=np.int64)
        driven = np.array([keyframes[owner].driven_m for owner in owners])
        away = np.hypot(poses[owners, 0] - place.x, poses[owners, 1] - place.y)
        turned = np.abs((poses[owners, 2] - place.yaw_rad + np.pi) % (2.0 * np.pi) - np.pi)
        same = (turned <= rule.same_view_rad) & (np.abs(driven - driven_m) <= rule.together_m)
        away = np.where(same, away, np.inf)
        return int(np.argmin(away)) if away.min(initial=np.inf) <= rule.same_view_m else None

    def _best_claim(
        self,
        sight: Sight,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        covariances: NDArray[np.float64],
    ) -> _Claim | None:
        """The place that the lidar confirms, unless it confirms two."""
        claims: list[_Claim] = []
        for number in self._candidates(sight, keyframes, covariances):
            match = match_sights(self._store.sights[number], sight)
            if match is None:
                continue
            edge = confirm(keyframes, poses, self._store.keyframes[number], match)
            if edge is not None:
                claims.append(_Claim(edge, match.inliers))
        if not claims:
            return None
        best = max(claims, key=lambda claim: claim.inliers)
        return None if any(self._are_rivals(best, other, poses) for other in claims) else best

    def _candidates(
        self, sight: Sight, keyframes: Sequence[Keyframe], covariances: NDArray[np.float64]
    ) -> list[int]:
        """Numbers of remembered sights that look alike, the most alike first, each of another place."""
        rule, votes = self._rule, self._store.votes(sight)
        owners = np.array(self._store.keyframes, dtype=np.int64)
        driven = np.array([keyframes[owner].driven_m for owner in owners])
        spread = np.sqrt(covariances[owners, 0, 0] + covariances[owners, 1, 1])
        useful = (keyframes[-1].driven_m - driven >= rule.driven_m) & (spread > rule.known_m)
        chosen: list[int] = []
        for number in np.argsort(-votes, kind="stable"):
            if votes[number] < rule.votes or len(chosen) == rule.per_keyframe:
                break
            apart = all(abs(driven[number] - driven[other]) >= rule.spacing_m for other in chosen)
            if useful[number] and apart:
                chosen.append(int(number))
        return chosen

    def _are_rivals(self, best: _Claim, other: _Claim, poses: NDArray[np.float64]) -> bool:
        """Whether another claim is nearly as good and puts the robot elsewhere."""
        places = [
            Pose2(*poses[claim.edge.a].tolist()).compose(claim.edge.relative) for claim in (best, other)
        ]
        apart = places[0].distance_to(places[1]) > self._rule.rival_m
        return apart and other.inliers >= self._rule.rival * best.inliers

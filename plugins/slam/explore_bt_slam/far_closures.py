"""Closures across large drift: the last metres of way, laid as one piece onto every place in question."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, wrap_angle
from explore_bt_slam.consistency import between, largest_consistent
from explore_bt_slam.contradiction import seen_through
from explore_bt_slam.correlative import ScoreGrid, search
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import gather_points, gather_surfels, stretch_about
from explore_bt_slam.point_to_line import Alignment, align
from explore_bt_slam.pose_graph import Edge, closure_edge

__all__ = ["FarClosureFinder", "FarRule", "Sighting", "unrivalled"]

_CELL_M = 0.1
_QUERY_POINTS = 150
_MOST_GRIDS = 200
"""Of 1 to 3 MB each; what was not asked for longest is forgotten."""
_OTHER_POSE_M = 1.0
_OTHER_POSE_RAD = 0.3


@dataclass(frozen=True, slots=True)
class FarRule:
    """What may become a closure across large drift.

    Attributes:
        driven_m: at least this much way lies between a place and the robot.
        spacing_m: way between the places tried, and between two tries.
        stretch_m: way whose scans make up a place, and the piece that is laid onto it.
        reach_m: farther points take no part.
        window_m: the robot is sought up to this far from a place's middle.
        sigmas: places within so many standard deviations are tried.
        score: least share of the piece that lies on the place.
        ambiguity: another pose, anywhere, with more than this share of the best score: "cannot tell".
        overlap: least share of the newest scan that fits the place's lines.
        seen_through: largest share of the place's points that the scan looks right through.
        agreeing, span_m: so many closures over so much way must say the same about the drift.
        expected_m: half that way is enough for closures that find the robot as near as this to where the
            graph has it: a false one would hardly happen to.
    """

    driven_m: float = 10.0
    spacing_m: float = 1.0
    stretch_m: float = 5.0
    reach_m: float = 12.0
    window_m: float = 3.0
    sigmas: float = 3.5
    score: float = 0.55
    ambiguity: float = 0.87
    overlap: float = 0.65
    seen_through: float = 0.12
    agreeing: int = 3
    span_m: float = 3.0
    expected_m: float = 0.3


@dataclass(frozen=True, slots=True)
class Sighting:
    """The piece fits here: ``pose`` is ``T_map_base`` as the place sees it."""

    place: int
    pose: Pose2
    score: float


class FarClosureFinder:
    """Seeks the robot among places whose position relative to it is badly known.

    A closure is only believed when a whole row of them agrees (pairwise consistency, Mangelson et al.
    2018) and when no other place explains the piece nearly as well.
    """

    def __init__(self, rule: FarRule | None = None) -> None:
        self._rule = rule or FarRule()
        self._grids: dict[int, tuple[int, ScoreGrid]] = {}
        self._pending: list[Edge] = []
        self._tried_m = -math.inf

    def find(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], covariances: NDArray[np.float64]
    ) -> list[Edge]:
        """Closures of the last few keyframes with places far along the graph; all of one opinion.

        Args:
            keyframes: all of them.
            poses: (N, 3) float64, theirs.
            covariances: (N, 3, 3) float64 relative to the newest, see ``relative_covariances``.
        """
        newest = len(keyframes) - 1
        if keyframes[newest].driven_m - self._tried_m < self._rule.spacing_m:
            return []
        places = self._places(keyframes, poses, covariances)
        if not places:
            return []
        self._tried_m = keyframes[newest].driven_m
        turns = {p: min(self._rule.sigmas * math.sqrt(covariances[p, 2, 2]) + 0.1, math.pi) for p in places}
        piece = self.piece(keyframes, poses, newest)
        found = self.sightings(keyframes, poses, piece, float(poses[newest, 2]), turns)
        best = unrivalled(found, self._rule.ambiguity)
        fitted = None if best is None else self.fitted(keyframes, poses, keyframes[newest], best)
        if best is None or fitted is None:
            return []
        edge = closure_edge(poses, best.place, newest, fitted)
        return self._agreed(edge, keyframes, poses, covariances)

    def sightings(
        self,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        points: NDArray[np.float64],
        yaw_rad: float,
        turns: dict[int, float],
    ) -> list[Sighting]:
        """Where a piece fits, and what rivals these places have within themselves (at infinity).

        Args:
            keyframes: all of them.
            poses: (N, 3) float64, theirs.
            points: (M, 2) float64, metres: the piece, base frame.
            yaw_rad: heading of the base, as far as it is known.
            turns: for each place to try, how far the heading may be off, rad.
        """
        rule = self._rule
        piece = _thinned(points[np.hypot(points[:, 0], points[:, 1]) <= rule.reach_m], _QUERY_POINTS)
        best = 0.0
        found: list[Sighting] = []
        for place, turn_rad in turns.items():
            here = Pose2(*poses[place].tolist())
            match = search(
                self._grid(keyframes, poses, place),
                piece,
                Pose2(0.0, 0.0, wrap_angle(yaw_rad - here.yaw_rad)),
                rule.window_m,
                turn_rad,
                rivals=rule.ambiguity,
                least=max(rule.score, rule.ambiguity * best),
            )
            if match.score > 0.0:
                best = max(best, match.score)
                found.append(Sighting(place, here.compose(match.pose), match.score))
                if match.runner_up > rule.ambiguity * best:
                    found.append(Sighting(place, Pose2(np.inf, np.inf, 0.0), match.runner_up))
        return found

    def recognised(
        self,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        scan: Keyframe,
        sightings: Sequence[Sighting],
    ) -> tuple[int, Pose2] | None:
        """The one place where a scan was taken, and ``T_map_base`` there; None if in doubt.

        Args:
            keyframes: all of them.
            poses: (N, 3) float64, theirs.
            scan: what is to be placed.
            sightings: of this scan at every place.
        """
        best = unrivalled(sightings, self._rule.ambiguity)
        found = None if best is None else self.fitted(keyframes, poses, scan, best)
        return None if best is None or found is None else (best.place, found.pose)

    def _places(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], covariances: NDArray[np.float64]
    ) -> list[int]:
        """Keyframes, one every few metres of way, where the robot may be but is not known to be."""
        newest, rule = len(keyframes) - 1, self._rule
        off = poses[:, :2] - poses[newest, :2]
        chosen: list[int] = []
        last_m = -math.inf
        for index in range(newest):
            driven_m = keyframes[index].driven_m
            if keyframes[newest].driven_m - driven_m < rule.driven_m:
                break
            if driven_m - last_m < 2.0 * rule.spacing_m:
                continue
            spread = covariances[index, :2, :2]
            if np.isfinite(spread).all() and _can_be_here(off[index], spread, rule):
                chosen.append(index)
                last_m = driven_m
        return chosen

    def piece(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], newest: int
    ) -> NDArray[np.float64]:
        """(N, 2): what was seen over the last metres, from the newest keyframe."""
        since_m = keyframes[newest].driven_m - self._rule.stretch_m
        recent = [k for k in range(newest, max(newest - 16, -1), -1) if keyframes[k].driven_m >= since_m]
        return _from(poses[newest], gather_points(keyframes, poses, recent), self._rule.reach_m)

    def piece_about(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], middle: int
    ) -> NDArray[np.float64]:
        """(N, 2): what was seen over the metres before and after a keyframe, from there."""
        stretch = stretch_about(keyframes, middle, 0.5 * self._rule.stretch_m)
        return _from(poses[middle], gather_points(keyframes, poses, stretch), self._rule.reach_m)

    def _grid(self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], place: int) -> ScoreGrid:
        """A place as it looks from its middle keyframe; hardly changes when the graph moves.

        It is drawn anew while the robot still drives on from there.
        """
        stretch = stretch_about(keyframes, place, self._rule.stretch_m)
        known = self._grids.pop(place, None)
        if known is None or known[0] != stretch[-1]:
            points = _from(poses[place], gather_points(keyframes, poses, stretch), self._rule.reach_m + 3.0)
            known = (stretch[-1], ScoreGrid(_thinned(points, 4000), 0.5, _CELL_M))
        self._grids[place] = known
        if len(self._grids) > _MOST_GRIDS:
            del self._grids[next(iter(self._grids))]
        return known[1]

    def fitted(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], scan: Keyframe, sighting: Sighting
    ) -> Alignment | None:
        """The sighting refined, if the scan fits the place's lines and looks through no wall."""
        rule, scan = self._rule, scan.within(self._rule.reach_m)
        stretch = stretch_about(keyframes, sighting.place, rule.stretch_m)
        cloud = gather_points(keyframes, poses, stretch)
        near = cloud[np.hypot(*(cloud - np.array(sighting.pose.xy)).T) <= rule.reach_m]
        if near.shape[0] == 0:
            return None
        fine = search(ScoreGrid(near, 0.3), _thinned(scan.points, 120), sighting.pose, 0.25, 0.05, rivals=1.0)
        surfels = gather_surfels(keyframes, poses, stretch, fine.pose.xy, rule.reach_m)
        found = align(scan.points, scan.normals, surfels, fine.pose, fine.pose, np.eye(3) * 1e-3)
        is_sound = (
            found.overlap >= rule.overlap
            and found.residual_m <= 0.05
            and found.weakest_sigma_m <= 0.03
            and seen_through(near, scan.points, found.pose) <= rule.seen_through
        )
        return found if is_sound else None

    def _agreed(
        self,
        edge: Edge,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        covariances: NDArray[np.float64],
    ) -> list[Edge]:
        """All closures that agree with the newest, once they are many enough; else wait."""
        rule = self._rule
        since_m = keyframes[edge.b].driven_m - 6.0 * rule.span_m
        self._pending = [each for each in self._pending if keyframes[each.b].driven_m >= since_m] + [edge]
        agreed = largest_consistent(self._pending, poses, covariances)
        span_m = max(keyframes[each.b].driven_m for each in agreed) - min(
            keyframes[each.b].driven_m for each in agreed
        )
        is_majority = 2 * len(agreed) > len(self._pending)
        is_expected = edge.relative.distance_to(between(poses, edge.a, edge.b)) <= rule.expected_m
        enough_m = 0.5 * rule.span_m if is_expected else rule.span_m
        if len(agreed) < rule.agreeing or span_m < enough_m or not is_majority:
            return []
        self._pending = []
        return agreed


def _can_be_here(off: NDArray[np.float64], spread: NDArray[np.float64], rule: FarRule) -> bool:
    """Badly known, and not too far off for how badly."""
    worst = float(np.linalg.eigvalsh(spread)[-1])
    if 3.0 * math.sqrt(worst) <= 0.5:
        return False
    wide = spread + np.eye(2) * (0.5 * rule.window_m) ** 2
    return float(off @ np.linalg.solve(wide, off)) <= rule.sigmas**2


def unrivalled(sightings: Iterable[Sighting], ambiguity: float) -> Sighting | None:
    """The best, unless a clearly different pose comes to more than a share of its score."""
    ranked = sorted(sightings, key=lambda each: -each.score)
    for other in ranked[1:]:
        is_other = (
            other.pose.distance_to(ranked[0].pose) > _OTHER_POSE_M
            or abs(wrap_angle(other.pose.yaw_rad - ranked[0].pose.yaw_rad)) > _OTHER_POSE_RAD
        )
        if is_other and other.score > ambiguity * ranked[0].score:
            return None
    return ranked[0] if ranked and math.isfinite(ranked[0].pose.x) else None


def _from(pose: NDArray[np.float64], points: NDArray[np.float64], reach_m: float) -> NDArray[np.float64]:
    seen = Pose2(*pose.tolist()).inverse().apply(points)
    return seen[np.hypot(seen[:, 0], seen[:, 1]) <= reach_m]


def _thinned(points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """One point a 20 cm cell, and about ``count`` of them, spread evenly over the list."""
    _, first = np.unique(np.floor(points / 0.2).astype(np.int64), axis=0, return_index=True)
    chosen = np.sort(first)
    return points[chosen[:: max(len(chosen) // count, 1)]]

"""Loop closures: places seen before, found near the estimate and verified from the lidar."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.agreement import Agreement
from explore_bt_slam.correlative import ScoreGrid, search
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import gather_points, gather_surfels, stretch_about
from explore_bt_slam.point_to_line import Alignment, align
from explore_bt_slam.pose_graph import Edge, closure_edge

__all__ = ["ClosureFinder", "ClosureRule"]

_INNER_SHARE = 0.8
"""A best pose nearer to the window's edge is no peak: what lies beyond may be better."""


@dataclass(frozen=True, slots=True)
class ClosureRule:
    """What may become a closure.

    Attributes:
        driven_m: at least this much way lies between the two keyframes.
        distance_m: farther apart they share too little to match.
        per_keyframe: at most so many attempts, spread over different places.
        spacing_m: between the places tried.
        reach_m: farther points take no part.
        stretch_m: an old place is what was seen over so much way before and after it.
        overlap, overlap_wide: least share of the scan that must fit the old map, in a narrow and in a wide
            window.
        ambiguity: a rival pose with more than this share of the best score means "cannot tell".
        points: a scan with fewer returns says too little about a place.
        gate: χ² of three degrees of freedom that a closure may be off from the graph's own belief.
        wide_m: closures searched in a window wider than this wait for a second, consistent one.
        window_max_m, window_max_rad: beyond, see ``FarClosureFinder``.
    """

    driven_m: float = 4.0
    distance_m: float = 2.5
    per_keyframe: int = 5
    spacing_m: float = 1.0
    reach_m: float = 8.0
    stretch_m: float = 3.0
    overlap: float = 0.55
    overlap_wide: float = 0.65
    ambiguity: float = 0.85
    wide_m: float = 0.5
    window_max_m: float = 3.0
    window_max_rad: float = 0.5
    gate: float = 16.3
    points: int = 40


class ClosureFinder:
    """Proposes closures for the newest keyframe; keeps the doubtful ones until a second one agrees."""

    def __init__(self, rule: ClosureRule | None = None) -> None:
        self._rule = rule or ClosureRule()
        self._agreement = Agreement()

    def find(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], covariances: NDArray[np.float64]
    ) -> list[Edge]:
        """Verified closures between the newest keyframe and older ones.

        Args:
            keyframes: all of them.
            poses: (N, 3) float64, theirs.
            covariances: (N, 3, 3) float64 relative to the newest, see ``relative_covariances``.
        """
        newest = len(keyframes) - 1
        edges: list[Edge] = []
        if keyframes[newest].points.shape[0] < self._rule.points:
            return edges
        for old in self._candidates(keyframes, poses, covariances):
            window_m = self._window_m(covariances[old])
            if window_m > self._rule.window_max_m:
                continue
            edge = self._match(keyframes, poses, covariances[old], old, newest, window_m)
            if edge is None:
                continue
            if window_m <= self._rule.wide_m:
                edges.append(edge)
            else:
                edges.extend(self._agreement.of(edge, poses, covariances))
        return edges

    def _candidates(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], covariances: NDArray[np.float64]
    ) -> list[int]:
        """Old keyframes worth a try: the nearest of each place, after enough way in between."""
        newest, rule = len(keyframes) - 1, self._rule
        driven = np.array([keyframe.driven_m for keyframe in keyframes])
        distance = np.hypot(poses[:, 0] - poses[newest, 0], poses[:, 1] - poses[newest, 1])
        slack = np.minimum(
            3.0 * np.sqrt(covariances[:, 0, 0] + covariances[:, 1, 1]), self._rule.window_max_m
        )
        near = (driven[newest] - driven >= rule.driven_m) & (distance <= rule.distance_m + slack)
        chosen: list[int] = []
        for index in np.flatnonzero(near)[np.argsort(distance[near], kind="stable")]:
            apart = [float(np.hypot(*(poses[index, :2] - poses[other, :2]))) for other in chosen]
            if keyframes[index].points.shape[0] >= rule.points and all(
                gap >= rule.spacing_m for gap in apart
            ):
                chosen.append(int(index))
            if len(chosen) == rule.per_keyframe:
                break
        return chosen

    def _window_m(self, covariance: NDArray[np.float64]) -> float:
        """Half the side of the search: three standard deviations of the worst direction, and a cell."""
        worst = float(np.linalg.eigvalsh(covariance[:2, :2])[-1]) if np.isfinite(covariance[0, 0]) else 100.0
        return 3.0 * math.sqrt(max(worst, 0.0)) + 0.05

    def _match(
        self,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        covariance: NDArray[np.float64],
        old: int,
        newest: int,
        window_m: float,
    ) -> Edge | None:
        """Search, refine, verify; None where any of it fails."""
        rule, scan = self._rule, keyframes[newest].within(self._rule.reach_m)
        predicted = Pose2(*poses[newest].tolist())
        chosen = stretch_about(keyframes, old, rule.stretch_m)
        guess = predicted
        if window_m > 0.1:
            window_rad = min(3.0 * math.sqrt(float(covariance[2, 2])) + 0.02, rule.window_max_rad)
            grid = ScoreGrid(self._near(gather_points(keyframes, poses, chosen), predicted), 0.5)
            match = search(
                grid, scan.points[:: max(scan.points.shape[0] // 150, 1)], predicted, window_m, window_rad
            )
            off_m = max(abs(match.pose.x - predicted.x), abs(match.pose.y - predicted.y))
            if match.runner_up > rule.ambiguity * match.score or off_m > _INNER_SHARE * window_m:
                return None
            guess = match.pose
        surfels = gather_surfels(keyframes, poses, chosen, predicted.xy, rule.reach_m + window_m)
        found = align(scan.points, scan.normals, surfels, guess, guess, np.eye(3) * 1e-3)
        if not self._is_sound(found, predicted, covariance, window_m):
            return None
        return closure_edge(poses, old, newest, found)

    def _near(self, points: NDArray[np.float64], pose: Pose2) -> NDArray[np.float64]:
        """Those of (N, 2) points that the scan can reach in its window."""
        reach_m = self._rule.reach_m + self._rule.window_max_m
        return points[np.hypot(points[:, 0] - pose.x, points[:, 1] - pose.y) <= reach_m]

    def _is_sound(
        self, found: Alignment, predicted: Pose2, covariance: NDArray[np.float64], window_m: float
    ) -> bool:
        """Enough of the scan fits, every direction is pinned, and the graph finds it credible."""
        off = np.array(
            [found.pose.x - predicted.x, found.pose.y - predicted.y, predicted.between(found.pose).yaw_rad]
        )
        credible = covariance + np.diag([0.02, 0.02, 0.01]) ** 2
        surprise = float(off @ np.linalg.solve(credible, off))
        return (
            found.overlap
            >= (self._rule.overlap if window_m <= self._rule.wide_m else self._rule.overlap_wide)
            and found.residual_m <= 0.05
            and found.weakest_sigma_m <= max(0.02, 0.1 * window_m)
            and surprise <= self._rule.gate
        )

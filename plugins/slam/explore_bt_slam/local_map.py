"""The surroundings that a scan is registered against, gathered from keyframes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.surfels import SurfelMap

__all__ = ["gather_points", "gather_surfels", "one_every", "stretch_about", "trusted_neighbours"]

_RECENT = 12
_MOST = 60


def trusted_neighbours(
    poses: NDArray[np.float64], covariances: NDArray[np.float64], source: int, reach_m: float, sigma_m: float
) -> list[int]:
    """Keyframes to match against from ``source``: near, and surely placed relative to it.

    Those made shortly before and after it always count. Others must be within ``reach_m`` and known to
    ``sigma_m`` along the graph, so that a part of the map that drift has displaced is not matched against
    before a closure has tied it.

    Args:
        poses: (N, 3) float64 keyframe poses.
        covariances: (N, 3, 3) float64, see ``relative_covariances``.
        source: the keyframe to look from.
        reach_m: how far others may be.
        sigma_m: how unsure their place may be.
    """
    distance = np.hypot(poses[:, 0] - poses[source, 0], poses[:, 1] - poses[source, 1])
    spread = np.sqrt(covariances[:, 0, 0] + covariances[:, 1, 1])
    recent = np.abs(np.arange(poses.shape[0]) - source) < _RECENT
    wanted = (distance <= reach_m) & ((spread <= sigma_m) | recent)
    chosen = np.flatnonzero(wanted)
    nearest = chosen[np.argsort(distance[chosen], kind="stable")][:_MOST]
    return sorted(int(index) for index in nearest)


def one_every(keyframes: Sequence[Keyframe], spacing_m: float) -> list[int]:
    """The first keyframe, and then one every so many metres of way."""
    chosen: list[int] = []
    for index, keyframe in enumerate(keyframes):
        if not chosen or keyframe.driven_m - keyframes[chosen[-1]].driven_m >= spacing_m:
            chosen.append(index)
    return chosen


def stretch_about(keyframes: Sequence[Keyframe], middle: int, half_m: float) -> list[int]:
    """The keyframes driven through within ``half_m`` of way before and after one of them."""
    driven = keyframes[middle].driven_m
    most = round(4.0 * half_m)
    return [
        index
        for index in range(max(middle - most, 0), min(middle + most + 1, len(keyframes)))
        if abs(keyframes[index].driven_m - driven) <= half_m
    ]


def gather_points(
    keyframes: Sequence[Keyframe], poses: NDArray[np.float64], chosen: Iterable[int]
) -> NDArray[np.float64]:
    """(N, 2) float64, ``map`` frame: all points of the chosen keyframes."""
    clouds = [Pose2(*poses[index].tolist()).apply(keyframes[index].map_points) for index in chosen]
    return np.concatenate(clouds) if clouds else np.zeros((0, 2))


def gather_surfels(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    chosen: Iterable[int],
    centre_xy: tuple[float, float],
    half_side_m: float,
) -> SurfelMap:
    """The line pieces of the chosen keyframes about a centre."""
    surfels = SurfelMap(centre_xy, half_side_m)
    for index in chosen:
        surfels.add(keyframes[index].map_points, keyframes[index].map_normals, Pose2(*poses[index].tolist()))
    return surfels

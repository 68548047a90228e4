"""The lidar's word on where the camera believes to be."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import gather_surfels, stretch_about
from explore_bt_slam.point_to_line import Alignment, align
from explore_bt_slam.pose_graph import Edge
from explore_bt_slam.sight_match import SightMatch

__all__ = ["confirm"]

_POINTS = 40
_HALF_SIDE_M = 9.0
_OVERLAP = 0.7
_OVERLAP_BACK = 0.5
_RESIDUAL_M = 0.05
_GATE = 16.3  # χ² of three degrees of freedom, 99.9 %
_HELD = np.eye(3) * 1e8
_LIDAR = np.diag([0.03, 0.03, 0.01]) ** 2
_FLOOR = np.diag([0.005, 0.005, 0.002]) ** 2


def confirm(
    keyframes: Sequence[Keyframe], poses: NDArray[np.float64], old: int, match: SightMatch
) -> Edge | None:
    """The closure old → newest if the scans agree with what the camera says; None if not.

    The newest scan must lie on the map about the old keyframe and the old scan, seen from there, on the map
    about the newest one. Where the walls leave a direction open the camera's own word stands.

    Args:
        keyframes: all of them.
        poses: (N, 3) float64, theirs, ``map`` frame.
        old: the keyframe that was recognised.
        match: how the newest lies to it by the camera.
    """
    newest = len(keyframes) - 1
    if min(keyframes[newest].points.shape[0], keyframes[old].points.shape[0]) < _POINTS:
        return None
    old_pose = Pose2(*poses[old].tolist())
    guess = old_pose.compose(match.relative)
    spread = _turned(match.covariance, old_pose.yaw_rad)
    found = _laid_on(keyframes, poses, newest, old, guess, np.asarray(np.linalg.inv(spread)))
    off = np.array([found.pose.x - guess.x, found.pose.y - guess.y, guess.between(found.pose).yaw_rad])
    if (
        found.overlap < _OVERLAP
        or found.residual_m > _RESIDUAL_M
        or float(off @ np.linalg.solve(spread + _LIDAR, off)) > _GATE
    ):
        return None
    relative = old_pose.between(found.pose)
    back_guess = Pose2(*poses[newest].tolist()).compose(relative.inverse())
    back = _laid_on(keyframes, poses, old, newest, back_guess, _HELD)
    if back.overlap < _OVERLAP_BACK:
        return None
    posterior = np.linalg.inv(found.information + np.linalg.inv(spread))
    return Edge(old, newest, relative, _turned(posterior, -found.pose.yaw_rad) + _FLOOR, is_closure=True)


def _laid_on(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    scan: int,
    place: int,
    guess: Pose2,
    information: NDArray[np.float64],
) -> Alignment:
    """One keyframe's scan on the map about another, held at ``guess`` with (3, 3) ``information``."""
    chosen = stretch_about(keyframes, place, 2.0)
    surfels = gather_surfels(keyframes, poses, chosen, guess.xy, _HALF_SIDE_M)
    return align(keyframes[scan].points, keyframes[scan].normals, surfels, guess, guess, information)


def _turned(covariance: NDArray[np.float64], yaw_rad: float) -> NDArray[np.float64]:
    """(3, 3) of axes turned by ``yaw_rad``, in the axes they are turned against."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return turn @ covariance @ turn.T

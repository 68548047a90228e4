"""What a camera image leaves behind: described points in space."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, RgbdFrame

__all__ = ["Sight", "SightMaker"]

_FEATURES = 500
_KEPT = 200
_CELLS = (6, 8)
_PER_CELL = 10
_NEAR_M, _FAR_M = 0.2, 6.0
_FLAT = 0.03
_FAST_THRESHOLD = 10
_PIXEL_SIGMA = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Features of one image that have a place in space; immutable by custom.

    Attributes:
        descriptors: (N, 32) uint8, ORB.
        points: (N, 3) float32, metres, frame of the keyframe's base, z up.
        sigmas_m: (N,) float32, metres: standard deviation of a point's place.
    """

    descriptors: NDArray[np.uint8]
    points: NDArray[np.float32]
    sigmas_m: NDArray[np.float32]


class SightMaker:
    """ORB features (Rublee et al. 2011) with registered depth, at most 200 an image, spread over it."""

    def __init__(self) -> None:
        self._orb = cv2.ORB.create(nfeatures=_FEATURES, fastThreshold=_FAST_THRESHOLD)

    def sight(self, frame: RgbdFrame, T_keyframe_base: Pose2) -> Sight:
        """The features of a frame, in the frame of a keyframe.

        Args:
            frame: taken at ``T_keyframe_base`` with the robot level.
            T_keyframe_base: where the robot was, seen from the keyframe.
        """
        # features without depth are of no use, and the strongest ones are often far off: ask for others
        with np.errstate(invalid="ignore"):
            is_placed = (frame.depth_m >= _NEAR_M) & (frame.depth_m <= _FAR_M)
        keypoints, descriptors = self._orb.detectAndCompute(frame.grey, is_placed.astype(np.uint8))
        if descriptors is None:
            return Sight(np.zeros((0, 32), np.uint8), np.zeros((0, 3), np.float32), np.zeros(0, np.float32))
        pixels = np.array([keypoint.pt for keypoint in keypoints])
        depths = _flat_depths(frame.depth_m, pixels)
        strength = np.array([keypoint.response for keypoint in keypoints])
        chosen = _spread_out(pixels, np.where(np.isfinite(depths), strength, -np.inf), frame.depth_m.shape)
        pixels, depths = pixels[chosen], depths[chosen]
        rays = (pixels - [frame.cx, frame.cy]) / [frame.fx, frame.fy]
        in_sensor = np.column_stack((rays * depths[:, None], depths))
        in_base = in_sensor @ frame.T_base_sensor[:3, :3].T + frame.T_base_sensor[:3, 3]
        points = np.column_stack((T_keyframe_base.apply(in_base[:, :2]), in_base[:, 2]))
        # stereo and structured light: the error of depth grows with its square (Khoshelham 2012)
        sigmas = np.hypot(0.005 + 0.003 * depths**2, _PIXEL_SIGMA * depths / frame.fx)
        return Sight(descriptors[chosen], points.astype(np.float32), sigmas.astype(np.float32))


def _flat_depths(depth_m: NDArray[np.float32], pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) depth at each pixel; NaN where its 3 × 3 neighbours disagree, as at the edge of a thing."""
    rows, cols = depth_m.shape
    u = np.clip(np.rint(pixels[:, 0]).astype(np.int64), 1, cols - 2)
    v = np.clip(np.rint(pixels[:, 1]).astype(np.int64), 1, rows - 2)
    steps = np.array([(dv, du) for dv in (-1, 0, 1) for du in (-1, 0, 1)])
    around = depth_m[v[:, None] + steps[:, 0], u[:, None] + steps[:, 1]].astype(np.float64)
    middle = np.median(around, axis=1)
    # a missing neighbour makes the median, and so everything after it, NaN
    with np.errstate(invalid="ignore"):
        gap = around.max(axis=1) - around.min(axis=1)
        flat = gap <= _FLAT * middle * (1.0 + middle)
        return np.where(flat & (middle >= _NEAR_M) & (middle <= _FAR_M), middle, np.nan)


def _spread_out(
    pixels: NDArray[np.float64], strength: NDArray[np.float64], shape: tuple[int, ...]
) -> NDArray[np.int64]:
    """The strongest features, so many from each cell of the image; -inf marks those of no use."""
    rows, cols = _CELLS
    cell = (pixels[:, 1] * rows // shape[0]) * cols + pixels[:, 0] * cols // shape[1]
    taken = np.zeros(rows * cols, dtype=np.int64)
    chosen: list[int] = []
    for index in np.argsort(-strength, kind="stable"):
        if strength[index] == -np.inf or len(chosen) == _KEPT:
            break
        if taken[int(cell[index])] < _PER_CELL:
            taken[int(cell[index])] += 1
            chosen.append(int(index))
    return np.array(chosen, dtype=np.int64)

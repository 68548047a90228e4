"""``sensor_msgs/Image`` and ``CameraInfo`` as the arrays of an RGB-D frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["COLOURS", "DEPTHS", "Lens", "colour", "depth_m"]

COLOURS = {"mono8": 1, "rgb8": 3, "bgr8": 3, "rgba8": 4, "bgra8": 4}
"""Encodings of the image that is looked at, with their channels."""
DEPTHS = {"16UC1": "u2", "32FC1": "f4"}
"""Encodings of depth: millimetres (REP-118's raw form) and metres."""
_MODELS = ("", "plumb_bob", "rational_polynomial")
_LARGEST = 1 << 14

_Pixels = NDArray[np.generic]


def colour(message: Any) -> NDArray[np.uint8]:
    """(H, W) uint8 grey or (H, W, 3) uint8 RGB.

    Raises:
        ValueError: another encoding, or fewer bytes than the header tells of.
    """
    if message.encoding not in COLOURS:
        raise ValueError(f'its encoding is "{message.encoding}"; expected {", ".join(COLOURS)}')
    pixels = _pixels(message, "u1", COLOURS[message.encoding]).astype(np.uint8)
    if pixels.shape[2] == 1:
        return np.ascontiguousarray(pixels[:, :, 0])
    order = [2, 1, 0] if message.encoding.startswith("bgr") else [0, 1, 2]
    return np.ascontiguousarray(pixels[:, :, order])


def depth_m(message: Any) -> NDArray[np.float32]:
    """(H, W) float32, metres along the optical axis; NaN where the camera measured nothing.

    Raises:
        ValueError: the same.
    """
    if message.encoding not in DEPTHS:
        raise ValueError(f'its encoding is "{message.encoding}"; expected {", ".join(DEPTHS)}')
    raw = _pixels(message, DEPTHS[message.encoding], 1)[:, :, 0].astype(np.float32)
    metres = raw * np.float32(0.001) if message.encoding == "16UC1" else raw
    return np.where(np.isfinite(metres) & (metres > 0.0), metres, np.float32(np.nan))


def _pixels(message: Any, kind: str, channels: int) -> _Pixels:
    height, width, step = int(message.height), int(message.width), int(message.step)
    dtype = np.dtype((">" if message.is_bigendian else "<") + kind)
    row = width * channels * dtype.itemsize
    data = np.asarray(message.data, dtype=np.uint8)
    if not (0 < height <= _LARGEST and 0 < width <= _LARGEST):
        raise ValueError(f"it has {width} × {height} pixels; expected 1 to {_LARGEST} a side")
    if step < row or len(data) < step * height:
        raise ValueError(
            f"{len(data)} bytes in rows of {step} for {width} × {height} pixels of {message.encoding}; "
            f"expected {height} rows of at least {row}"
        )
    rows = np.ascontiguousarray(data[: step * height].reshape(height, step)[:, :row])
    return rows.view(dtype).reshape(height, width, channels)


@dataclass(frozen=True, slots=True, eq=False)
class Lens:
    """Intrinsics of an image without distortion, and how to get there.

    Attributes:
        fx, fy, cx, cy: pixels.
        straighten: takes an (H, W[, 3]) array and whether its values may be mixed.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    straighten: Callable[[Any, bool], Any]

    @classmethod
    def of(cls, info: Any, *, rectified: bool) -> Lens:
        """From a ``CameraInfo``: its P for rectified images, else K and the distortion D.

        Raises:
            ValueError: no focal length, or a distortion model other than plumb_bob, rational_polynomial.
        """
        K = np.array(getattr(info, "K", getattr(info, "k", ())), dtype=np.float64).reshape(3, 3)
        P = np.array(getattr(info, "P", getattr(info, "p", ())), dtype=np.float64).reshape(3, 4)
        D = np.array(getattr(info, "D", getattr(info, "d", ())), dtype=np.float64)
        use = P[:, :3] if rectified and P[0, 0] > 0.0 else K
        figures = (float(use[0, 0]), float(use[1, 1]), float(use[0, 2]), float(use[1, 2]))
        if not (np.isfinite(figures).all() and min(figures[:2]) > 0.0):
            raise ValueError(f"fx, fy, cx, cy are {figures}; expected a calibrated camera")
        if rectified or not D.any():
            return cls(*figures, lambda pixels, _: pixels)
        if info.distortion_model not in _MODELS or len(D) not in (4, 5, 8) or not np.isfinite(D).all():
            raise ValueError(
                f'distortion model "{info.distortion_model}" with {len(D)} numbers; expected plumb_bob or '
                "rational_polynomial, or rectified images"
            )
        size = (int(info.width), int(info.height))
        if not all(0 < side <= _LARGEST for side in size):
            raise ValueError(f"it is for {size[0]} × {size[1]} pixels; expected 1 to {_LARGEST} a side")
        first, second = cv2.initUndistortRectifyMap(K, D, np.eye(3), K, size, cv2.CV_32FC1)

        def straighten(pixels: Any, mixed: bool) -> Any:
            how = cv2.INTER_LINEAR if mixed else cv2.INTER_NEAREST
            edge = 0.0 if mixed else float("nan")
            return cv2.remap(
                pixels, first, second, how, borderMode=cv2.BORDER_CONSTANT, borderValue=(edge,) * 3
            )

        return cls(*figures, straighten)

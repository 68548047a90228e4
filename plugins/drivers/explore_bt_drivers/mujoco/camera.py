"""An RGB-D camera: colour and depth of one pass, noise that grows with range."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import RgbdFrame
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.rotations import matrices
from explore_bt_drivers.mujoco.scene import Surroundings
from explore_bt_drivers.mujoco.screen import Screen, View
from explore_bt_drivers.mujoco.track import Track

__all__ = ["RgbdCamera"]

_FIELD_RAD = math.radians(46.0)
_NEAREST_M = 0.2
_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Axes of the optical frame (z ahead, x right, y down) in those of the mount (x ahead, z up)."""


class RgbdCamera:
    """Looks straight ahead; 46° high, 59° wide. It sees glass, and of a mirror only its face.

    Depth is the distance along the axis, registered; NaN below 0.2 m, beyond the range, and in the sky. Its
    standard deviation grows with its square, as that of stereo and structured light does (Khoshelham 2012).
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        surroundings: Surroundings,
        options: MujocoOptions,
        rng: np.random.Generator,
    ) -> None:
        """Open it.

        Args:
            model: compiled of the surroundings' scene.
            surroundings: people and things; settled up to the time that is measured.
            options: size (not ``off``), rate, range, noise, mount.
            rng: noise.

        Raises:
            UserError: the library that draws is missing.
        """
        assert options.image_size is not None
        self._screen = Screen(model, surroundings, options.image_size, robot=False)
        self._rate_hz, self._range_m = options.camera_rate, options.camera_range
        self._noise_per_m = options.depth_noise if options.noise else 0.0
        self._rng = rng
        self._mount = np.eye(4)
        self._mount[:3, :3], self._mount[:3, 3] = _OPTICAL, options.camera_mount
        self._mount.flags.writeable = False
        self._images = 0

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._images = track.due(self._rate_hz)

    def measure(self, track: Track) -> list[RgbdFrame]:
        """The images due since the last call."""
        due = track.due(self._rate_hz)
        frames = [self._image(track, k / self._rate_hz) for k in range(self._images + 1, due + 1)]
        self._images = due
        return frames

    def close(self) -> None:
        """Let go of the library that draws. Idempotent."""
        self._screen.close()

    def _image(self, track: Track, stamp_s: float) -> RgbdFrame:
        positions, quaternions = track.at(np.array([stamp_s]))
        turn = matrices(quaternions)[0]
        eye = positions[0] + turn @ self._mount[:3, 3]
        image, depth = self._screen.take(View(eye, turn[:, 0], turn[:, 2], _FIELD_RAD), stamp_s)
        width, height = self._screen.size
        focal = height / 2.0 / math.tan(_FIELD_RAD / 2.0)
        measured = self._measured(depth)
        for array in (image, measured):
            array.flags.writeable = False
        centre = ((width - 1) / 2.0, (height - 1) / 2.0)
        return RgbdFrame(stamp_s, image, measured, focal, focal, *centre, self._mount)

    def _measured(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        if self._noise_per_m > 0.0:
            noise = self._rng.standard_normal(depth.shape, dtype=np.float32)
            near = np.minimum(depth, np.float32(2.0 * self._range_m))  # noise of the sky would be infinite
            depth = depth + np.float32(self._noise_per_m) * noise * near * near
        return np.where((depth >= _NEAREST_M) & (depth <= self._range_m), depth, np.float32(math.nan))

"""The robot in its world as a bystander sees it, and in a corner what its camera looks at."""

from __future__ import annotations

import math
from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Filming
from explore_bt_drivers.mujoco.rotations import matrices
from explore_bt_drivers.mujoco.scene import Surroundings
from explore_bt_drivers.mujoco.screen import Screen, View
from explore_bt_drivers.mujoco.track import Track

__all__ = ["WorldFilm"]

_FROM_ROBOT = np.array([-1.2, -3.0, 4.6])
"""The bystander's eye, metres from the robot: high enough to look into a room over its walls."""
_LOOKED_AT_M = 0.3
_FIELD_RAD = math.radians(50.0)
_INSET_FIELD_RAD = math.radians(46.0)
_INSET_SHARE, _INSET_EDGE = 0.3, 2


class WorldFilm(Filming):
    """A picture follows the robot from a direction that stays the same."""

    def __init__(
        self,
        model: mujoco.MjModel,
        surroundings: Surroundings,
        size: tuple[int, int],
        mount: tuple[float, float, float],
        now: Callable[[], tuple[Track, NDArray[np.float64]]],
    ) -> None:
        """Open both pictures.

        Args:
            model: compiled of the surroundings' scene.
            surroundings: people and things.
            size: width and height, pixels.
            mount: of the camera, from ``base_link``, metres.
            now: the body's track and the model's state (nq,).

        Raises:
            UserError: the library that draws is missing.
        """
        width, height = size
        inset = (round(width * _INSET_SHARE) // 2 * 2, round(height * _INSET_SHARE) // 2 * 2)
        self._world = Screen(model, surroundings, size, robot=True)
        self._eye = Screen(model, surroundings, inset, robot=False)
        self._mount, self._now = np.array(mount), now

    def frame(self) -> NDArray[np.uint8]:
        """The robot from above, what it sees at the lower right."""
        track, state = self._now()
        position = track.positions[-1]
        turn = matrices(track.quaternions[-1:])[0]
        image, _ = self._world.take(_bystander(position), track.now_s, state)
        ahead = View(position + turn @ self._mount, turn[:, 0], turn[:, 2], _INSET_FIELD_RAD)
        seen, _ = self._eye.take(ahead, track.now_s)
        rows, cols = seen.shape[0] + _INSET_EDGE, seen.shape[1] + _INSET_EDGE
        image[-rows:, -cols:] = 255
        image[-rows + _INSET_EDGE :, -cols + _INSET_EDGE :] = seen
        return image

    def close(self) -> None:
        """Let go of the library that draws. Idempotent."""
        self._world.close()
        self._eye.close()


def _bystander(robot: NDArray[np.float64]) -> View:
    ahead = np.array((0.0, 0.0, _LOOKED_AT_M)) - _FROM_ROBOT
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    up = np.cross(right / np.linalg.norm(right), ahead)
    return View(robot + _FROM_ROBOT, ahead, up, _FIELD_RAD)

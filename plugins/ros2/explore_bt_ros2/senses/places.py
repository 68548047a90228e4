"""Where sensors sit on the robot, as tf tells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt_ros2.transforms import TransformBuffer

__all__ = ["Places"]

_MOVED_M = 0.05
_MOVED_RAD = 0.05


class Places:
    """Looks a frame up once; a sensor that moves on the robot later is refused.

    Args:
        buffer: what tf said.
        base_frame: of the robot.
        world_frames: in which the robot moves: what hangs in them is not on the robot.
    """

    def __init__(self, buffer: TransformBuffer, base_frame: str, world_frames: Sequence[str] = ()) -> None:
        self._world = world_frames
        self._buffer = buffer
        self._base = base_frame
        self._known: dict[str, NDArray[np.float64]] = {}

    def of(self, frame: str) -> NDArray[np.float64]:
        """(4, 4) float64 ``T_base_sensor``.

        Raises:
            ValueError: nothing ties the frame to the base, it is not on the robot, or it has jumped.
        """
        now = self.known(frame)
        if now is None:
            heard = ", ".join(self._buffer.frames()) or "none"
            raise ValueError(
                f'nothing on tf ties its frame "{frame}" to {self._base}; frames on tf: {heard}; type ros2 '
                f"run tf2_ros static_transform_publisher --frame-id {self._base} --child-frame-id {frame}"
            )
        if self._buffer.meeting(self._base, frame) in self._world:
            raise ValueError(f'its frame "{frame}" is not on the robot: the robot moves in it')
        first = self._known.setdefault(frame, now)
        if first is not now:
            off = np.linalg.inv(first) @ now
            turn = np.arccos(np.clip(0.5 * (np.trace(off[:3, :3]) - 1.0), -1.0, 1.0))
            if np.linalg.norm(off[:3, 3]) > _MOVED_M or turn > _MOVED_RAD:
                shift_m = float(np.linalg.norm(off[:3, 3]))
                raise ValueError(
                    f'its frame "{frame}" has jumped by {shift_m:.2f} m and {turn:.2f} rad on tf'
                )
        return first

    def known(self, frame: str) -> NDArray[np.float64] | None:
        """(4, 4) float64 ``T_base_sensor``; None where nothing ties the frame to the base."""
        return np.eye(4) if frame.lstrip("/") == self._base else self._buffer.find(self._base, frame)

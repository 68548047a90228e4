"""Where sensors sit on the robot, from static transforms."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["Mountings", "Places", "link_of", "planar", "rotation_of"]

_FARTHEST_M = 1e6
_STILL = 1e-3
_BASES = ("base_link", "base_footprint", "base")


class Places(Protocol):
    """Who knows where sensors sit on the robot."""

    def of(self, frame: str) -> NDArray[np.float64]:
        """(4, 4) float64 ``T_base_sensor``."""

    def known(self, frame: str) -> NDArray[np.float64] | None:
        """The same; None where nothing ties the frame to the robot."""


class Mountings:
    """The tree of frames that do not move on the robot.

    Args:
        notes: takes one sentence for each frame whose place on the robot nobody told.
    """

    def __init__(self, notes: list[str]) -> None:
        self._notes = notes
        self._parents: dict[str, tuple[str, NDArray[np.float64]]] = {}
        self._seen: dict[str, tuple[str, NDArray[np.float64]] | None] = {}
        self._known: dict[str, NDArray[np.float64]] = {}

    def learn(self, message: Any) -> None:
        """Take in a ``tf2_msgs/TFMessage``.

        Raises:
            ValueError: a transform that is none.
        """
        for each in message.transforms:
            self._parents[_plain(each.child_frame_id)] = link_of(each)

    def watch(self, message: Any) -> None:
        """Take in a ``tf2_msgs/TFMessage`` of transforms that may move: one that never does is as good.

        Raises:
            ValueError: the same.
        """
        for each in message.transforms:
            child, (parent, transform) = _plain(each.child_frame_id), link_of(each)
            before = self._seen.setdefault(child, (parent, transform))
            if before and (before[0] != parent or not np.allclose(before[1], transform, atol=_STILL)):
                self._seen[child] = None

    def of(self, frame: str) -> NDArray[np.float64]:
        """(4, 4) float64 ``T_base_sensor``; the identity where nothing ties the frame to the robot."""
        name = _plain(frame)
        if name not in self._known:
            found = self.known(frame)
            if found is None:
                self._notes.append(
                    f'nothing tells where frame "{frame}" is on the robot: taken for base_link'
                )
            self._known[name] = np.eye(4) if found is None else found
        return self._known[name]

    def known(self, frame: str) -> NDArray[np.float64] | None:
        """(4, 4) float64 ``T_base_sensor``; None where nothing ties the frame to the robot."""
        frame = _plain(frame)
        transform, passed = np.eye(4), {frame}
        while frame not in _BASES:
            link = self._parents.get(frame) or self._seen.get(frame)
            if link is None:
                return None
            frame, step = link
            if frame in passed:
                return None
            passed.add(frame)
            transform = step @ transform
        return transform


def link_of(transform: Any) -> tuple[str, NDArray[np.float64]]:
    """Parent frame and (4, 4) float64 ``T_parent_child`` of a ``geometry_msgs/TransformStamped``.

    Raises:
        ValueError: a transform that is none.
    """
    T = np.eye(4)
    T[:3, :3] = rotation_of(transform.transform.rotation)
    shift = transform.transform.translation
    T[:3, 3] = shift.x, shift.y, shift.z
    if not (np.abs(T[:3, 3]) < _FARTHEST_M).all():
        raise ValueError(f"the translation to {transform.child_frame_id} is {T[:3, 3].tolist()} m")
    return _plain(transform.header.frame_id), T


def rotation_of(quaternion: Any) -> NDArray[np.float64]:
    """(3, 3) float64 of a ``geometry_msgs/Quaternion``.

    Raises:
        ValueError: it has no length, or is not finite.
    """
    q = np.array([quaternion.w, quaternion.x, quaternion.y, quaternion.z], dtype=np.float64)
    length = float(np.linalg.norm(q)) if (np.abs(q) < 1e6).all() else 0.0
    if not length > 1e-6:
        raise ValueError(f"{q.tolist()} (w, x, y, z) is no rotation; expected a unit quaternion")
    w, x, y, z = q / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def planar(rotation: NDArray[np.float64]) -> float:
    """Heading of a (3, 3) rotation's x axis in the plane, radians."""
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


def _plain(frame: str) -> str:
    return frame.lstrip("/")

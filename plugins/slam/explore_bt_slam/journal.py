"""The whole way so far, tied to keyframes so that it moves with the graph; and what it cost."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, Trajectory

__all__ = ["Journal"]


class Journal:
    """One entry a scan."""

    def __init__(self) -> None:
        self._stamps: list[float] = []
        self._keyframes: list[int] = []
        self._relatives: list[tuple[float, float, float]] = []
        self._milliseconds: list[float] = []

    def note(self, stamp_s: float, keyframe: int, relative: Pose2) -> None:
        """A scan was taken at ``relative`` to a keyframe."""
        self._stamps.append(stamp_s)
        self._keyframes.append(keyframe)
        self._relatives.append((relative.x, relative.y, relative.yaw_rad))

    def took(self, seconds: float) -> None:
        """What the last scan cost."""
        self._milliseconds.append(1000.0 * seconds)

    def trajectory(self, keyframe_poses: NDArray[np.float64]) -> Trajectory:
        """The way under the present poses of the keyframes, (N, 3) float64."""
        stamps, keyframes, relatives = self.arrays()
        base = keyframe_poses.reshape(-1, 3)[keyframes]
        cos, sin = np.cos(base[:, 2]), np.sin(base[:, 2])
        poses = np.column_stack(
            (
                base[:, 0] + cos * relatives[:, 0] - sin * relatives[:, 1],
                base[:, 1] + sin * relatives[:, 0] + cos * relatives[:, 1],
                (base[:, 2] + relatives[:, 2] + np.pi) % (2.0 * np.pi) - np.pi,
            )
        )
        return Trajectory(stamps, poses)

    def figures(self) -> dict[str, float]:
        """Scans, and milliseconds per scan."""
        taken = np.array(self._milliseconds) if self._milliseconds else np.zeros(1)
        return {
            "scans": float(len(self._stamps)),
            "ms_per_scan_median": float(np.median(taken)),
            "ms_per_scan_p99": float(np.percentile(taken, 99.0)),
        }

    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
        """(N,) stamps, (N,) keyframes, (N, 3) poses relative to them."""
        return (
            np.array(self._stamps, dtype=np.float64),
            np.array(self._keyframes, dtype=np.int64),
            np.array(self._relatives, dtype=np.float64).reshape(-1, 3),
        )

    def restore(
        self, stamps: NDArray[np.float64], keyframes: NDArray[np.int64], relatives: NDArray[np.float64]
    ) -> None:
        """A saved journal."""
        self._stamps = stamps.tolist()
        self._keyframes = keyframes.tolist()
        self._relatives = [(x, y, yaw) for x, y, yaw in relatives.tolist()]

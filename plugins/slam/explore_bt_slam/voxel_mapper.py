"""From posed 3D sweeps to voxel submaps, and from these to the grid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.levelling import LevelCloud
from explore_bt.types import GridWindow, Pose2
from explore_bt_slam.canvas import Canvas
from explore_bt_slam.mapper import KeptSweep, Mapper, apart, has_moved
from explore_bt_slam.voxel_map import Columns, Heights, VoxelMap

__all__ = ["VoxelMapper"]

_SUBMAP_EVERY_M = 2.5
_REFRESH_S = 0.5
_LEVER_M = 0.5  # a lidar sits no farther from the base's centre


class VoxelMapper(Mapper):
    """Sends each sweep to the submap of its place, and keeps the grid in step with voxels and graph.

    A sweep is taken in after 0.1 m, 0.1 rad or 0.5 s. A new submap begins 2.5 m from all that the robot
    surely knows the way to; inside them old ones learn on, so that memory grows with the area seen alone.

    Args:
        resolution_m: side of a cell and of a voxel.
        body_radius_m: of the robot's footprint.
        heights: of floor and obstacle band.
        reach_m: range of the lidar.
        revision: of the grid that this one takes the place of.
        clear_start_m: floor about the start that is known, though no beam reaches it.
    """

    def __init__(
        self,
        resolution_m: float,
        body_radius_m: float,
        heights: Heights,
        reach_m: float,
        revision: int,
        clear_start_m: float = 0.0,
    ) -> None:
        super().__init__(resolution_m, body_radius_m)
        self._canvas = Canvas(resolution_m, body_radius_m, revision)
        self.voxels = VoxelMap(
            resolution_m, reach_m + _LEVER_M, _SUBMAP_EVERY_M + 1.0, heights, body_radius_m, clear_start_m
        )
        self._active = -1
        self._drawn_poses = np.zeros((0, 3))

    def forget_near(self, position: tuple[float, float], radius_m: float) -> bool:  # noqa: ARG002  # it cannot
        """The voxels would bring it back."""
        return False

    @property
    def submap_poses(self) -> NDArray[np.float64]:
        """(S, 3) float64 as the graph has them, ``map`` frame."""
        return np.array(
            [
                Pose2(*self._keyframes[submap.keyframe].tolist()).compose(submap.relative).as_array()
                for submap in self.voxels.submaps
            ]
        ).reshape(-1, 3)

    def choose_submap(self, keyframe: int, known: NDArray[np.bool_]) -> None:
        """The robot is at this keyframe now.

        Args:
            keyframe: its number; ``follow`` has told where it is.
            known: (N,) bool: keyframes whose place relative to it is sure.
        """
        here = self._keyframes[keyframe, :2]
        poses = self.submap_poses
        distance = np.hypot(poses[:, 0] - here[0], poses[:, 1] - here[1])
        sure = np.array([known[submap.keyframe] for submap in self.voxels.submaps], dtype=np.bool_)
        distance = np.where(sure, distance, np.inf)
        if distance.size and distance.min() <= _SUBMAP_EVERY_M:
            self._active = int(distance.argmin())
            return
        cell_m = self.voxels.cell_m  # in line with the grid, until the graph moves it
        square = Pose2(round(here[0] / cell_m) * cell_m, round(here[1] / cell_m) * cell_m, 0.0)
        pose = Pose2(*self._keyframes[keyframe].tolist())
        self._active = self.voxels.add_submap(keyframe, pose.between(square))
        self._drawn_poses = np.vstack((self._drawn_poses, square.as_array()))

    def see_cloud(self, cloud: LevelCloud, velocity_mps: NDArray[np.float64], pose: Pose2) -> None:
        """Take in a sweep from ``pose``, ``map`` frame, if it is worth it."""
        if self._drawn_at is not None:
            last, stamp_s = self._drawn_at
            if not apart(last, pose) and cloud.stamp_s - stamp_s < _REFRESH_S:
                return
        self._drawn_at = (pose, cloud.stamp_s)
        frame = Pose2(*self.submap_poses[self._active].tolist())
        self._draw(
            [(self.voxels.learn(self._active, cloud, velocity_mps, frame.between(pose)), self._active_drawn)]
        )

    def follow(self, keyframes: NDArray[np.float64]) -> None:
        """The graph's poses, (N, 3): redraw submaps that have moved by more than 1 cm or 0.1° since drawn."""
        self.redraw(keyframes)

    def redraw(self, keyframes: NDArray[np.float64]) -> None:
        """Draw the grid anew where moved submaps were and where they are now."""
        self._keyframes = keyframes.copy()
        before, now = self._drawn_poses, self.submap_poses
        slots = [k for k in range(now.shape[0]) if has_moved(before[k : k + 1], now[k : k + 1])]
        self._drawn_poses = before.copy()
        self._drawn_poses[slots] = now[slots]
        self._draw(
            [
                (self.voxels.all_columns(slot), Pose2(*poses[slot].tolist()))
                for slot in slots
                for poses in (before, now)
            ]
        )

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The grid and the voxels."""
        return {**super().arrays(), **self.voxels.arrays(), "voxel_drawn_poses": self._drawn_poses}

    def restore(
        self, arrays: Mapping[str, NDArray[Any]], kept: list[KeptSweep], keyframes: NDArray[np.float64]
    ) -> None:
        """The map of a saved state."""
        super().restore(arrays, kept, keyframes)
        self.voxels.restore(arrays)
        self._drawn_poses = arrays["voxel_drawn_poses"].copy()

    @property
    def _active_drawn(self) -> Pose2:
        return Pose2(*self._drawn_poses[self._active].tolist())

    def _draw(self, seen: list[tuple[Columns, Pose2]]) -> None:
        """Classify anew all cells in these columns of submaps at these poses."""
        found = [self.voxels.bounds(columns, pose) for columns, pose in seen]
        boxes = [bounds for bounds in found if bounds is not None]
        if not boxes:
            return
        bounds = np.concatenate((np.min(boxes, axis=0)[:2], np.max(boxes, axis=0)[2:]))
        order = [slot for slot in self.voxels.newest_first() if self._overlaps(slot, bounds)]

        def paint(cells: NDArray[np.int8], corner: NDArray[np.float64]) -> GridWindow:
            wanted = np.zeros(cells.shape, np.bool_)
            for columns, pose in seen:
                self.voxels.mark(columns, pose, wanted, corner)
            return self.voxels.draw(cells, wanted, corner, order, self._drawn_poses)

        self._canvas.paint(bounds, paint)

    def _overlaps(self, slot: int, bounds: NDArray[np.float64]) -> bool:
        columns = self.voxels.all_columns(slot)
        own = self.voxels.bounds(columns, Pose2(*self._drawn_poses[slot].tolist()))
        return own is not None and bool((own[:2] < bounds[2:]).all() and (own[2:] > bounds[:2]).all())

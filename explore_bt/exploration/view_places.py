"""Where a robot may stand to look round, and what it would see from there."""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.blocks import Blocks
from explore_bt.exploration.outlook import Outlook, Outlooks
from explore_bt.exploration.reach import Reach

__all__ = ["ViewPlaces"]

_SPARSE_M = 0.6
_DENSE_M = 0.3
_SAME_M = 0.3
_NEAR_M = 1.5


class ViewPlaces:
    """Of every square of floor the roomiest block that the robot can come to: most lie on the skeleton.

    Attributes:
        reach: what the robot can come to.
        blocks: (N, 2) int64 rows and columns of blocks of its ground.
        xy: (N, 2) float64, metres, ``map`` frame: where to stand in each.
        way_blocks: (N, 2) int64: in which of the larger blocks of its ways they lie.
        travel_m: (N,) float64, the ways to them from the robot.
    """

    def __init__(
        self, reach: Reach, *, dense_m: float = 0.0, more: NDArray[np.float64] | None = None
    ) -> None:
        """Choose the places.

        Args:
            reach: what the robot can come to.
            dense_m: squares of 0.3 m where the way is no longer than this, of 0.6 m elsewhere. In the fine
                ones only places within 1.5 m of a frontier count.
            more: (N, 2) metres, further places; those out of reach are left out.
        """
        self.reach = reach
        blocks = self._roomiest(_SPARSE_M)
        if more is not None and len(more):
            extra = reach.ground.block_of(more)
            extra = extra[((extra >= 0) & (extra < reach.room_m.shape)).all(axis=1)]
            blocks = np.concatenate((blocks, extra[reach.room_m[tuple(extra.T)] > 0.0]))
        dense = self._roomiest(_DENSE_M) if dense_m > 0.0 else blocks[:0]
        dense = dense[reach.from_here_m[tuple(reach.way_block_of(dense).T)] <= dense_m]
        self.blocks: NDArray[np.int64] = np.concatenate((blocks, dense))
        self.xy = reach.points(self.blocks)
        self.way_blocks = reach.way_block_of(self.blocks)
        self.travel_m = reach.from_here_m[tuple(self.way_blocks.T)].astype(np.float64)
        self._is_dense = np.arange(len(self.blocks)) >= len(blocks)

    def _roomiest(self, side_m: float) -> NDArray[np.int64]:
        best = Blocks.over(self.reach.ground.grid, side_m).best_cells(self.reach.room_m)
        return best[best[..., 0] >= 0]

    def without(self, spots: NDArray[np.float64]) -> ViewPlaces:
        """The same places but those within 0.3 m of one of ``spots``, (M, 2) metres, ``map`` frame."""
        apart = self.xy[:, None] - spots[None]
        is_kept = (np.hypot(apart[..., 0], apart[..., 1]) > _SAME_M).all(axis=1)
        others = copy(self)
        others.blocks, others.xy, others._is_dense = (
            self.blocks[is_kept],
            self.xy[is_kept],
            self._is_dense[is_kept],
        )
        others.way_blocks, others.travel_m = self.way_blocks[is_kept], self.travel_m[is_kept]
        return others

    def look(
        self, outlooks: Outlooks, range_m: float, depth_m: float, min_patch_m2: float
    ) -> tuple[Outlook, float, int]:
        """What each shows, the area in m² of a block in it, and how many blocks there are.

        Args:
            outlooks: remembers what was seen before.
            range_m: the lidar's range.
            depth_m: how far into the unknown an opening is believed.
            min_patch_m2: smaller patches of unknown are noise between beams, and looked over.
        """
        near_m = np.where(self._is_dense, _NEAR_M, range_m)
        outlook = self._look_from(self.blocks, near_m, outlooks, range_m, depth_m, min_patch_m2)
        blocks = self.reach.ground.grid
        return outlook, blocks.resolution_m**2, blocks.cells.size

    def look_from(
        self,
        spots: NDArray[np.float64],
        outlooks: Outlooks,
        range_m: float,
        depth_m: float,
        min_patch_m2: float,
    ) -> Outlook:
        """What each of (N, 2) other spots, metres, ``map`` frame, shows; else as ``look``."""
        blocks = self.reach.ground.block_of(spots)
        blocks = blocks[((blocks >= 0) & (blocks < self.reach.room_m.shape)).all(axis=1)]
        near_m = np.full(len(blocks), range_m)
        return self._look_from(blocks, near_m, outlooks, range_m, depth_m, min_patch_m2)

    def _look_from(
        self,
        blocks: NDArray[np.int64],
        near_m: NDArray[np.float64],
        outlooks: Outlooks,
        range_m: float,
        depth_m: float,
        min_patch_m2: float,
    ) -> Outlook:
        ground = self.reach.ground
        side_m = ground.grid.resolution_m
        return outlooks.look(
            ground.without_specks(min_patch_m2),
            blocks,
            range_m / side_m,
            depth_m / side_m,
            first=ground.blocks.first,
            near_cells=near_m / side_m,
        )

"""Where the robot can come to, in blocks."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.blocks import Blocks
from explore_bt.exploration.ground import Ground
from explore_bt.exploration.travel import Travel

__all__ = ["Reach"]

_GO_M = 0.2
"""Side of the blocks that ways are measured over."""


class Reach:
    """The blocks that a robot can come to from where it is, how roomy they are, and the ways between them.

    Attributes:
        ground: the map in blocks.
        room_m: (rows, columns) float32: clearance of each block's middle, and at least r; 0 out of reach.
        from_here_m: float32, metres from the robot to each of the larger blocks, see :meth:`ways_m`.
    """

    def __init__(
        self,
        ground: Ground,
        clearance_m: NDArray[np.float32],
        here_xy: tuple[float, float],
        radius_m: float,
        *,
        clearance_weight: float = 0.5,
    ) -> None:
        """Find them.

        Args:
            ground: the map in blocks.
            clearance_m: (rows, cols) float32, as from :func:`clearance_field`, of the map itself: what it
                calls passable is, down to gaps that no block's middle lies in.
            here_xy: the robot, metres, ``map`` frame.
            radius_m: r, with what it shall have to spare.
            clearance_weight: what a metre at the walls costs more than a roomy one.
        """
        self.ground = ground
        source = ground.source
        self._reached = Travel(clearance_m, radius_m, source.resolution_m).reached(source.cell_of(*here_xy))
        self._best = ground.blocks.best_cells(np.where(self._reached, clearance_m, np.float32(0.0)))
        is_in = self._best[..., 0] >= 0
        self.room_m = np.where(is_in, np.maximum(ground.room_m, np.float32(radius_m)), np.float32(0.0))
        self._go = Blocks.over(ground.grid, _GO_M)
        self._travel = Travel(
            self._roomiest(),
            radius_m,
            self._go.side * ground.grid.resolution_m,
            clearance_weight=clearance_weight,
        )
        row, col = self.way_block_of(ground.block_of(np.array([here_xy])))[0].tolist()
        self.from_here_m = self.ways_m((row, col))

    def way_block_of(self, blocks: NDArray[np.int64]) -> NDArray[np.int64]:
        """(N, 2) of the larger blocks, which ways are measured over, that hold (N, 2) of the ground's."""
        return self._go.of(blocks)

    def ways_m(self, way_block: tuple[int, int], most_m: float = np.inf) -> NDArray[np.float32]:
        """Metres from a larger block to every other, tight ones counting more; see :func:`travel_field`."""
        return self._travel.field(way_block, most_m)

    def points(self, blocks: NDArray[np.int64]) -> NDArray[np.float64]:
        """(N, 2) metres, ``map`` frame: a point to stand on in each of (N, 2) blocks in reach.

        The middle, if all cells that it lies in or between can be come to; else that of the roomiest cell.
        """
        ground = self.ground
        side = ground.blocks.side
        last = blocks * side - np.asarray(ground.blocks.shift) + side // 2
        first = last - (1 - side % 2)
        is_open = np.ones(len(blocks), dtype=np.bool_)
        for rows, cols in product((first[:, 0], last[:, 0]), (first[:, 1], last[:, 1])):
            is_open &= self._is_reached(rows, cols)
        best = self._best[tuple(blocks.T)]
        return np.where(is_open[:, None], ground.grid.centers_of(blocks), ground.source.centers_of(best))

    def _is_reached(self, rows: NDArray[np.int64], cols: NDArray[np.int64]) -> NDArray[np.bool_]:
        high, wide = self._reached.shape
        inside = (rows >= 0) & (rows < high) & (cols >= 0) & (cols < wide)
        return inside & self._reached[np.clip(rows, 0, high - 1), np.clip(cols, 0, wide - 1)]

    def _roomiest(self) -> NDArray[np.float32]:
        """The room of the larger blocks: that of the roomiest in each."""
        best = self._go.best_cells(self.room_m)
        return np.where(best[..., 0] >= 0, self.room_m[best[..., 0], best[..., 1]], np.float32(0.0))

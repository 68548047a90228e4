"""Where a robot may stand to look round, and what it would see from there."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.blocks import Blocks, pooled_map
from explore_bt.exploration.outlook import Outlook, Outlooks
from explore_bt.exploration.travel import travel_field
from explore_bt.types import FREE, UNKNOWN, OccupancyGrid

__all__ = ["GO_M", "LOOK_M", "ViewPlaces"]

LOOK_M = 0.1
"""Side of the blocks that are looked at: finer maps decide as this one does."""
GO_M = 0.2
"""Side of the blocks that ways are measured over."""
_SPARSE_M = 0.6
_DENSE_M = 0.3
_SAME_M = 0.3
_NEAR_M = 1.5
_CHUNK = 64


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """The reachable floor in blocks: room is the clearance of the roomiest cell of each, 0 where none is."""

    blocks: Blocks
    room_m: NDArray[np.float32]
    radius_m: float
    resolution_m: float
    clearance_weight: float

    def field(self, block: tuple[int, int], most_m: float) -> NDArray[np.float32]:
        """Metres from a block to every other, tight ones counting more."""
        return travel_field(
            self.room_m,
            block,
            self.radius_m,
            self.blocks.side * self.resolution_m,
            clearance_weight=self.clearance_weight,
            most_m=most_m,
        )


class ViewPlaces:
    """Of every square of floor the roomiest cell that the robot can come to: most lie on the skeleton.

    Attributes:
        cells: (N, 2) int64 rows and columns.
        xy: (N, 2) float64, metres, ``map`` frame: their middles.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        clearance_m: NDArray[np.float32],
        travel_m: NDArray[np.float32],
        *,
        radius_m: float,
        dense_m: float = 0.0,
        more: NDArray[np.float64] | None = None,
    ) -> None:
        """Choose the places.

        Args:
            grid: the map.
            clearance_m: (rows, cols) float32, as from :func:`clearance_field`.
            travel_m: (rows, cols) float32, as from :func:`travel_field`.
            radius_m: r that ``travel_m`` was made with.
            dense_m: squares of 0.3 m as far as this from where ``travel_m`` is 0, of 0.6 m elsewhere. In the
                fine ones only places within 1.5 m of a frontier count.
            more: (N, 2) metres, further places; those out of reach are left out.
        """
        self.grid = grid
        self._radius_m = radius_m
        self._room = np.where(np.isfinite(travel_m), clearance_m, np.float32(0.0))
        cells = self._best_cells(_SPARSE_M)
        if more is not None and len(more):
            extra = grid.cells_of(more)
            inside = ((extra >= 0) & (extra < grid.shape)).all(axis=1)
            extra = extra[inside]
            cells = np.concatenate((cells, extra[self._room[tuple(extra.T)] > 0.0]))
        dense = self._best_cells(_DENSE_M) if dense_m > 0.0 else cells[:0]
        dense = dense[travel_m[tuple(dense.T)] <= dense_m]
        self.cells: NDArray[np.int64] = np.concatenate((cells, dense))
        self.xy = grid.centers_of(self.cells)
        self._is_dense = np.arange(len(self.cells)) >= len(cells)

    def _best_cells(self, side_m: float) -> NDArray[np.int64]:
        best = Blocks.over(self.grid, side_m).best_cells(self._room)
        return best[best[..., 0] >= 0]

    def without(self, spots: NDArray[np.float64]) -> ViewPlaces:
        """The same places but those within 0.3 m of one of ``spots``, (M, 2) metres, ``map`` frame."""
        apart = self.xy[:, None] - spots[None]
        others = copy(self)
        is_kept = (np.hypot(apart[..., 0], apart[..., 1]) > _SAME_M).all(axis=1)
        others.cells, others.xy = self.cells[is_kept], self.xy[is_kept]
        others._is_dense = self._is_dense[is_kept]
        return others

    def ways(self, clearance_weight: float) -> Ways:
        """The floor between them."""
        blocks = Blocks.over(self.grid, GO_M)
        best = blocks.best_cells(self._room)
        room = np.where(best[..., 0] >= 0, self._room[best[..., 0], best[..., 1]], np.float32(0.0))
        return Ways(blocks, room, self._radius_m, self.grid.resolution_m, clearance_weight)

    def look(
        self, outlooks: Outlooks, range_m: float, depth_m: float, min_patch_m2: float
    ) -> tuple[Outlook, float, int]:
        """What each shows, the area in m² of a cell in it, and how many cells there are.

        Args:
            outlooks: remembers what was seen before.
            range_m: the lidar's range.
            depth_m: how far into the unknown an opening is believed.
            min_patch_m2: smaller patches of unknown are noise between beams, and looked over.
        """
        blocks = Blocks.over(self.grid, LOOK_M, _CHUNK)
        side_m = blocks.side * self.grid.resolution_m
        cells = _without_specks(pooled_map(self.grid, blocks), min_patch_m2 / side_m**2)
        outlook = outlooks.look(
            cells,
            blocks.of(self.cells),
            range_m / side_m,
            depth_m / side_m,
            first=blocks.first,
            near_cells=np.where(self._is_dense, _NEAR_M, range_m) / side_m,
        )
        return outlook, side_m**2, cells.size


def _without_specks(cells: NDArray[np.int8], least_cells: float) -> NDArray[np.int8]:
    """Unknown patches of fewer cells (joined through edges, none at the map's edge) become floor."""
    unknown = np.ascontiguousarray(np.pad(cells == UNKNOWN, 1, constant_values=True)).view(np.uint8)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(unknown, connectivity=4)
    is_speck = stats[:, cv2.CC_STAT_AREA] < least_cells
    is_speck[0] = False
    return np.where(is_speck[labels[1:-1, 1:-1]], np.int8(FREE), cells)

"""Places of a known floor, what is seen from each, and the ways between them."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from explore_bt.evaluation.straight import is_open_line, straightened
from explore_bt.exploration import travel_field
from explore_bt.exploration.way_down import way_down

__all__ = ["Lookouts", "look_from"]

_MOST_PLACES = 4000
_MOST_TARGETS = 20_000
_REACH_BLOCKS = 2.3  # 20 neighbours: a way in any direction is at most 2 % too long
_RAYS = 720


class Lookouts:
    """A lattice of places where a footprint fits, each with the floor it sees, joined by straight lines.

    Attributes:
        cells: (N, 2) int64 rows and columns of the places; number 0 is the start.
        target_count: T: so many cells, evenly thinned, stand for the floor to be seen.
        graph: (N, N) sparse float64, metres: the lines that stay on reachable cells.
    """

    def __init__(
        self,
        free: NDArray[np.bool_],
        floor: NDArray[np.bool_],
        reachable: NDArray[np.bool_],
        start_cell: tuple[int, int],
        range_m: float,
        resolution_m: float,
        spacing_m: float = 0.4,
    ) -> None:
        """Looks about from every place.

        Args:
            free: (rows, cols) bool: where sight goes through.
            floor: (rows, cols) bool: what is to be seen.
            reachable: (rows, cols) bool: where the robot can be.
            start_cell: (row, col) where it begins, a reachable one.
            range_m: the lidar's.
            resolution_m: metres per cell.
            spacing_m: between places; more on large floors, which get some 4,000 places.
        """
        self._reachable = reachable
        self._resolution_m = resolution_m
        side = max(spacing_m / resolution_m, math.sqrt(np.count_nonzero(reachable) / _MOST_PLACES), 1.0)
        self.cells = np.concatenate(([start_cell], _one_per_block(reachable, round(side))))
        self.graph = self._joined(self._lines(_REACH_BLOCKS * round(side)))
        targets = np.argwhere(floor)
        stride = max(math.ceil(math.sqrt(len(targets) / _MOST_TARGETS)), 1)
        targets = targets[(targets % stride == stride // 2).all(axis=1)] if stride > 1 else targets
        self.target_count = len(targets)
        number = np.full(free.shape, -1, dtype=np.int32)
        number[targets[:, 0], targets[:, 1]] = np.arange(len(targets), dtype=np.int32)
        self.starts, self.seen = look_from(free, number, self.cells, range_m / resolution_m)
        self._trees: dict[int, tuple[NDArray[np.float64], NDArray[np.int32]]] = {}
        self._ways: dict[tuple[int, int], NDArray[np.int64]] = {}

    def distances_m(self, place: int) -> NDArray[np.float64]:
        """(N,) float64: length of the shortest way to every place."""
        return self._tree(place)[0]

    def way(self, begin: int, end: int) -> NDArray[np.int64]:
        """The places passed on the shortest way, both ends included."""
        if (begin, end) not in self._ways:
            before = self._tree(begin)[1]
            way = [end]
            while way[-1] != begin:
                way.append(int(before[way[-1]]))
            self._ways[begin, end] = np.array(way[::-1], dtype=np.int64)
        return self._ways[begin, end]

    def drive(self, order: list[int]) -> NDArray[np.int64]:
        """(M, 2) cells: the corners of a way through places in that order, every leg pulled straight."""
        corners = [self.cells[order[:1]]]
        for leg in itertools.pairwise(order):
            lines = [self._cells_between(*pair) for pair in itertools.pairwise(self.way(*leg).tolist())]
            if lines:
                corners.append(straightened(np.concatenate(lines), self._reachable)[1:])
        return np.concatenate(corners)

    def _tree(self, place: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        if place not in self._trees:
            distances_m, before = csgraph.dijkstra(
                self.graph, indices=np.array([place]), return_predecessors=True
            )
            self._trees[place] = (distances_m[0], before[0])
        return self._trees[place]

    def _lines(self, reach_cells: float) -> sparse.csr_array:
        """Straight lines between places that are near."""
        pairs = cKDTree(self.cells).query_pairs(reach_cells, output_type="ndarray").astype(np.int64)
        is_open = is_open_line(self._reachable, self.cells[pairs[:, 0]], self.cells[pairs[:, 1]])
        pairs = pairs[is_open]
        length = np.hypot(*(self.cells[pairs[:, 0]] - self.cells[pairs[:, 1]]).T) * self._resolution_m
        length = np.maximum(length, 1e-6)  # two places on one cell
        count = len(self.cells)
        one_way = sparse.coo_array((length, (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        return sparse.csr_array(one_way + one_way.T)

    def _joined(self, graph: sparse.csr_array) -> sparse.csr_array:
        """Ways round corners for groups of places that no straight line joins to the start."""
        while True:
            _, label = csgraph.connected_components(graph, directed=False)
            apart = np.flatnonzero(label != label[0])
            travel_m = self._travel_m(0) if len(apart) else np.empty(0)
            apart = apart[np.isfinite(travel_m[tuple(self.cells[apart].T)])] if len(apart) else apart
            if len(apart) == 0:
                return graph
            nearest = int(apart[np.argmin(travel_m[tuple(self.cells[apart].T)])])
            travel_m = self._travel_m(nearest)
            home = np.flatnonzero(label == label[0])
            to_m = travel_m[tuple(self.cells[home].T)]
            other, length = int(home[np.argmin(to_m)]), float(to_m.min())
            ends = (np.array([nearest, other]), np.array([other, nearest]))
            graph = sparse.csr_array(graph + sparse.coo_array(([length] * 2, ends), shape=graph.shape))

    def _travel_m(self, place: int) -> NDArray[np.float32]:
        room = np.where(self._reachable, 1.0, 0.0).astype(np.float32)
        return travel_field(room, self.cells[place], 0.5, self._resolution_m)

    def _cells_between(self, begin: int, end: int) -> NDArray[np.int64]:
        """The line between two joined places, cell by cell, or the way round the corner."""
        a, b = self.cells[begin], self.cells[end]
        if is_open_line(self._reachable, a[None], b[None])[0]:
            return np.rint(np.linspace(a, b, int(np.abs(b - a).max()) + 1)).astype(np.int64)
        return way_down(self._travel_m(begin), (int(b[0]), int(b[1])))


def _one_per_block(reachable: NDArray[np.bool_], side: int) -> NDArray[np.int64]:
    """(N, 2): of every square block the reachable cell nearest to its middle, if it has any."""
    places = np.argwhere(reachable)
    block = places // side
    off_centre = np.abs(places % side - (side - 1) / 2).sum(axis=1)
    order = np.lexsort((off_centre, block[:, 1], block[:, 0]))
    _, first = np.unique(block[order], axis=0, return_index=True)
    return places[order[first]]


def look_from(
    free: NDArray[np.bool_], number: NDArray[np.int32], cells: NDArray[np.int64], reach_cells: float
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """What is seen from the centres of some cells, with 720 rays each.

    Args:
        free: (rows, cols) bool: where sight goes through.
        number: (rows, cols) int32: the target on each cell, or -1.
        cells: (N, 2) where to look from.
        reach_cells: how far.

    Returns:
        starts (N + 1,) and targets (K,): place i sees ``targets[starts[i]:starts[i + 1]]``.
    """
    size = int(4.0 * (reach_cells + 1.0) ** 2) + 1
    last = np.full(int(number.max()) + 1 if number.size else 0, -1, dtype=np.int32)
    chunks, counts = [], np.zeros(len(cells) + 1, dtype=np.int64)
    buffer = np.empty(min(size, len(last)), dtype=np.int32)
    for i, (row, col) in enumerate(cells.tolist()):
        counts[i + 1] = _look(free, number, row, col, reach_cells, _RAYS, i, last, buffer)
        chunks.append(buffer[: counts[i + 1]].copy())
    return np.cumsum(counts), np.concatenate(chunks) if chunks else np.empty(0, dtype=np.int32)


@njit(cache=True)
def _look(free, number, row0, col0, reach, rays, mark, last, out):  # type: ignore[no-untyped-def]  # kernel
    """Write the targets along rays from a cell's centre; how many. ``last`` tells which are written."""
    rows, cols = free.shape
    found = 0
    for ray in range(rays):
        angle = 2.0 * math.pi * (ray + 0.5) / rays
        dx, dy = math.cos(angle), math.sin(angle)
        step_col = 1 if dx > 0.0 else -1
        step_row = 1 if dy > 0.0 else -1
        per_col, per_row = 1.0 / abs(dx), 1.0 / abs(dy)
        next_x, next_y = 0.5 * per_col, 0.5 * per_row
        row, col, entered = row0, col0, 0.0
        while entered <= reach and free[row, col]:
            target = number[row, col]
            if target >= 0 and last[target] != mark:
                last[target] = mark
                out[found] = target
                found += 1
            if next_x < next_y:
                entered = next_x
                next_x += per_col
                col += step_col
            else:
                entered = next_y
                next_y += per_row
                row += step_row
            if row < 0 or col < 0 or row >= rows or col >= cols:
                break
    return found

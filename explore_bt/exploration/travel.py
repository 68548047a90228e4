"""Travel distance from the robot to every place it can reach."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_at_least, require_positive
from explore_bt.exploration.escape import ways_out

__all__ = ["Travel", "nearest_reaching_cell", "travel_field", "way_lengths"]

_DIAGONAL = math.sqrt(2.0)


@njit(cache=True)
def _spread(passable, width, distance, factor, seeds, bucket_count, most):  # type: ignore[no-untyped-def]  # numba kernel
    """Shortest distances in cells over a padded, flattened mask; ``distance`` holds those of the seeds.

    Buckets are one cell wide: no step is shorter, so every cell in the lowest bucket is settled, in
    whatever order it is taken (Dial, 1969; Dinic, 1978). One loop on purpose: handing arrays to a helper
    at every step costs ten times the step.
    """
    steps = np.array((width, -width, -1, 1, width - 1, width + 1, -width - 1, -width + 1))
    beside = np.array((0, 0, 0, 0, width, width, -width, -width))  # of a diagonal; the other is the rest
    buckets = np.empty((bucket_count, passable.size + seeds.size), dtype=np.int32)
    filled = np.zeros(bucket_count, dtype=np.int64)
    due, level = 0, 0  # seeds come nearest first
    while level <= most and (due < seeds.size or filled.any()):
        bucket = level % bucket_count
        while due < seeds.size and int(distance[seeds[due]]) <= level:
            buckets[bucket, filled[bucket]] = seeds[due]
            filled[bucket] += 1
            due += 1
        for i in range(filled[bucket]):
            here = buckets[bucket, i]
            so_far = distance[here]
            if int(so_far) != level:  # it was settled from a lower bucket
                continue
            for k in range(8):
                there = here + steps[k]
                if not passable[there]:
                    continue
                length = 1.0
                if k >= 4:
                    if not (passable[here + beside[k]] and passable[there - beside[k]]):
                        continue
                    length = _DIAGONAL
                if factor.size:
                    length *= 0.5 * (factor[here] + factor[there])
                if so_far + length >= distance[there]:
                    continue
                due_in = int(so_far + length)
                if distance[there] >= due_in + 1:  # not yet in that bucket
                    queue = due_in % bucket_count
                    buckets[queue, filled[queue]] = there
                    filled[queue] += 1
                distance[there] = so_far + length
        filled[bucket] = 0
        level += 1


@njit(cache=True)
def _flood(passable, width, seeds):  # type: ignore[no-untyped-def]  # numba kernel
    """All that steps to the four neighbours come to over a padded, flattened mask.

    A diagonal step that needs both cells beside it comes nowhere else.
    """
    reached = np.zeros(passable.size, dtype=np.bool_)
    queue = np.empty(passable.size, dtype=np.int32)
    begin, end = 0, 0
    for seed in seeds:
        reached[seed] = True
        queue[end] = seed
        end += 1
    while begin < end:
        here = queue[begin]
        begin += 1
        for there in (here - width, here - 1, here + 1, here + width):
            if passable[there] and not reached[there]:
                reached[there] = True
                queue[end] = there
                end += 1
    return reached


class Travel:
    """Ways over one floor, from any start; the arguments are those of :func:`travel_field`."""

    def __init__(
        self,
        clearance_m: NDArray[np.float32],
        radius_m: float,
        resolution_m: float,
        *,
        clearance_weight: float = 0.0,
        comfort_m: float = 0.6,
        escape_m: float = 0.6,
    ) -> None:
        """Prepare what is the same for every start; raises as :func:`travel_field`."""
        require_positive(resolution_m=resolution_m)
        require_at_least(0, radius_m=radius_m, clearance_weight=clearance_weight, escape_m=escape_m)
        self._clearance_m = clearance_m
        self._radius_m, self._resolution_m, self._escape_m = radius_m, resolution_m, escape_m
        self._passable = np.zeros((clearance_m.shape[0] + 2, clearance_m.shape[1] + 2), dtype=np.bool_)
        np.logical_and(clearance_m >= radius_m, clearance_m > 0.0, out=self._passable[1:-1, 1:-1])
        self._factors = _factors(clearance_m, clearance_weight, comfort_m)
        self._buckets = math.ceil(_DIAGONAL * (1.0 + clearance_weight)) + 2

    def field(
        self, start_cells: NDArray[np.integer] | tuple[int, int], most_m: float = math.inf
    ) -> NDArray[np.float32]:
        """(rows, cols) float32, metres; see :func:`travel_field`; beyond ``most_m`` too high, or inf."""
        starts, seeds, climbed = self._ways_out(start_cells)
        distance = np.full(self._passable.shape, np.inf)
        distance[seeds[:, 0] + 1, seeds[:, 1] + 1] = climbed
        width = self._passable.shape[1]
        _spread(
            self._passable.ravel(),
            width,
            distance.ravel(),
            self._factors,
            (seeds + 1) @ np.array([width, 1]),
            self._buckets,
            most_m / self._resolution_m,
        )
        field = np.multiply(distance[1:-1, 1:-1], self._resolution_m, dtype=np.float32, casting="same_kind")
        field[starts[:, 0], starts[:, 1]] = 0.0
        return field

    def reached(self, start_cells: NDArray[np.integer] | tuple[int, int]) -> NDArray[np.bool_]:
        """(rows, cols) bool: where ``field`` is finite."""
        starts, seeds, _ = self._ways_out(start_cells)
        width = self._passable.shape[1]
        flat = _flood(self._passable.ravel(), width, (seeds + 1) @ np.array([width, 1]))
        reached = flat.reshape(self._passable.shape)[1:-1, 1:-1].copy()
        reached[starts[:, 0], starts[:, 1]] = True
        return reached

    def _ways_out(
        self, start_cells: NDArray[np.integer] | tuple[int, int]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Starts inside the grid; the first cells of the ways from them, and how far those are, in cells."""
        starts = np.asarray(start_cells, dtype=np.int64).reshape(-1, 2)
        starts = starts[((starts >= 0) & (starts < self._clearance_m.shape)).all(axis=1)]
        return starts, *ways_out(
            self._clearance_m, starts, self._radius_m, self._escape_m / self._resolution_m
        )


def _factors(clearance_m: NDArray[np.float32], weight: float, comfort_m: float) -> NDArray[np.float32]:
    """Cost of a metre by clearance, padded and flat; empty where a metre costs a metre everywhere."""
    if weight == 0.0:
        return np.empty(0, dtype=np.float32)
    require_positive(comfort_m=comfort_m)
    tightness = 1.0 - np.minimum(clearance_m / comfort_m, 1.0)
    return np.pad(np.asarray(1.0 + weight * tightness, dtype=np.float32), 1).ravel()


def travel_field(
    clearance_m: NDArray[np.float32],
    start_cells: NDArray[np.integer] | tuple[int, int],
    radius_m: float,
    resolution_m: float,
    *,
    clearance_weight: float = 0.0,
    comfort_m: float = 0.6,
    escape_m: float = 0.6,
) -> NDArray[np.float32]:
    """Length of the shortest way from the robot to every cell where its footprint fits.

    Steps go to the eight neighbours, at 1 and √2 cells, through cells with clearance ≥ r; a diagonal step
    needs both cells beside it, so no corner is cut. A start that is tighter than r is left as planners
    leave it: over free cells along which clearance never falls, for at most ``escape_m``.

    Args:
        clearance_m: (rows, cols) float32, as from :func:`clearance_field`.
        start_cells: (row, col), or (N, 2) of them; those outside the grid are ignored.
        radius_m: r, the footprint.
        resolution_m: metres per cell.
        clearance_weight: w; above 0, a metre costs 1 + w (1 − clearance/comfort) where clearance is below
            ``comfort_m``, and the field is a cost in metres of roomy floor.
        comfort_m: clearance from which on a metre costs a metre.
        escape_m: how far the robot may drive to leave a tight start.

    Returns:
        (rows, cols) float32, metres; 0 at the start, inf where the robot cannot stand or come.

    Raises:
        ArgumentError: if the resolution is not above zero, or r or the weight below zero.
    """
    travel = Travel(
        clearance_m,
        radius_m,
        resolution_m,
        clearance_weight=clearance_weight,
        comfort_m=comfort_m,
        escape_m=escape_m,
    )
    return travel.field(start_cells)


def way_lengths(
    passable: NDArray[np.bool_], starts: NDArray[np.integer], most_cells: float = math.inf
) -> NDArray[np.float64]:
    """Length of the shortest way from the nearest of some cells, over eight neighbours, no corner cut.

    Args:
        passable: (rows, cols) bool; the starts are among them.
        starts: (K, 2) row, column.
        most_cells: beyond it lengths may be too high.

    Returns:
        (rows, cols) float64, cells; inf where no way leads.
    """
    padded = np.pad(passable, 1)
    width = padded.shape[1]
    distance = np.full(padded.shape, np.inf)
    seeds = (np.asarray(starts, dtype=np.int64).reshape(-1, 2) + 1) @ np.array([width, 1])
    distance.ravel()[seeds] = 0.0
    plain = np.empty(0, dtype=np.float32)
    _spread(padded.ravel(), width, distance.ravel(), plain, seeds, math.ceil(_DIAGONAL) + 2, most_cells)
    return distance[1:-1, 1:-1]


def nearest_reaching_cell(
    travel_m: NDArray[np.float32], cell: tuple[int, int], within_cells: float = math.inf
) -> tuple[int, int] | None:
    """The reachable cell nearest to a given one, as the crow flies.

    Ties go to the shorter travel, then to the lower row and column.

    Args:
        travel_m: (rows, cols) float32, as from :func:`travel_field`.
        cell: (row, col), may lie outside the grid.
        within_cells: how far to look, in cells.

    Returns:
        (row, col), or None where no cell that near can be reached.
    """
    reach = min(within_cells, float(np.hypot(*travel_m.shape)) + math.hypot(*cell))
    row0, col0 = (max(0, math.floor(c - reach)) for c in cell)
    window = travel_m[
        row0 : max(0, math.ceil(cell[0] + reach) + 1), col0 : max(0, math.ceil(cell[1] + reach) + 1)
    ]
    rows, cols = np.nonzero(np.isfinite(window))
    square = (rows + row0 - cell[0]) ** 2 + (cols + col0 - cell[1]) ** 2
    near = np.flatnonzero(square <= reach**2)
    if near.size == 0:
        return None
    best = near[np.lexsort((travel_m[rows[near] + row0, cols[near] + col0], square[near]))[0]]
    return (int(rows[best] + row0), int(cols[best] + col0))

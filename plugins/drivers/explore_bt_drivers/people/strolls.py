"""Random walks over a world's floor, from one place to another by a shortest way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.errors import WorldError
from explore_bt.exploration import Travel
from explore_bt_drivers.people.strides import as_people_walk
from explore_bt_drivers.people.walks import Walk
from explore_bt_drivers.world import World, with_every_stand
from explore_bt_drivers.world.index import way_fits
from explore_bt_drivers.world.observable import reachable_cells

__all__ = ["Strolls"]

_SPARE_M = 0.05
_SLACK_M = 1e-5
_FROM_ROBOT_M = 2.0
_STROLL_M = 3.0
_LONGEST_M = 30.0


class Strolls:
    """Walks of people of one size over the floor that is joined to a place for them.

    They keep 5 cm more than their radius from everything, wherever it ever stands: a door that is shut at
    times is none of their ways.
    """

    def __init__(self, world: World, beside: tuple[float, float], radius_m: float, speed_mps: float) -> None:
        """Find the floor.

        Raises:
            WorldError: there is no floor wide enough.
        """
        whole = with_every_stand(world)
        # between the centres of neighbouring cells, too, nothing may come nearer than the radius
        self._room_m = radius_m + max(_SPARE_M, 0.71 * whole.floor.resolution_m)
        self._floor, self._index = whole.floor, whole.index
        fitting = reachable_cells(whole, beside, self._room_m)
        self._travel = Travel(fitting.astype(np.float32), 1.0, whole.floor.resolution_m)
        self._cells = self._joined(np.argwhere(fitting), beside)
        if len(self._cells) < 2:
            raise WorldError(
                f"{world.source}: walkers with a radius of {radius_m:g} m find no free floor that is "
                f"{2 * self._room_m:.2f} m wide; make walker_radius smaller, or leave walkers out"
            )
        self._beside = beside
        self._radius_m, self._speed_mps = radius_m, speed_mps

    def walk(self, rng: np.random.Generator) -> Walk:
        """Somebody's walk; ``rng`` is theirs alone."""
        return Walk(self._radius_m, as_people_walk(self._points(rng), self._speed_mps))

    def _joined(self, cells: NDArray[np.int64], beside: tuple[float, float]) -> NDArray[np.int64]:
        """(N, 2) cells that ways lead to from the one nearest to a place; none if there are no cells."""
        if len(cells) == 0:
            return cells
        nearest = int(np.argmin(np.hypot(*(self._floor.centers_of(cells) - beside).T)))
        return np.argwhere(self._travel.reached(cells[nearest]))

    def _points(self, rng: np.random.Generator) -> Iterator[tuple[float, float]]:
        """Corners of the way, without an end."""
        away = np.hypot(*(self._floor.centers_of(self._cells) - self._beside).T)
        far = self._cells[away >= min(_FROM_ROBOT_M, away.max())]
        here = far[rng.integers(len(far))]
        yield self._center(here)
        while True:
            way = self._way(rng, here)
            for cell in way[1:]:
                yield self._center(cell)
            here = way[-1]

    def _way(self, rng: np.random.Generator, here: NDArray[np.int64]) -> NDArray[np.int64]:
        """(N, 2) cells at the corners of a way to a random place, from ``here`` on."""
        row, col = (int(value) for value in here)
        metres = self._travel.field((row, col), _LONGEST_M)
        cells = np.argwhere((metres > 0.0) & (metres <= _LONGEST_M))
        away = np.hypot(*(cells - here).T) * self._floor.resolution_m
        far = cells[away >= min(_STROLL_M, away.max())]
        way = _descended(metres, *far[rng.integers(len(far))])[::-1].copy()
        places = self._floor.centers_of(way)
        return way[_pulled_tight(self._index, places, self._room_m - _SLACK_M)]

    def _center(self, cell: NDArray[np.int64]) -> tuple[float, float]:
        return self._floor.center_of(int(cell[0]), int(cell[1]))


@njit(cache=True)
def _descended(metres, row, col):  # type: ignore[no-untyped-def]  # kernel
    """(N, 2) cells from (row, col) down a field of distances to where it is 0, neighbour by neighbour."""
    way = [(row, col)]
    while metres[row, col] > 0.0:
        best_row, best_col = row, col
        for r in range(max(row - 1, 0), min(row + 2, metres.shape[0])):
            for c in range(max(col - 1, 0), min(col + 2, metres.shape[1])):
                if metres[r, c] < metres[best_row, best_col]:
                    best_row, best_col = r, c
        row, col = best_row, best_col
        way.append((row, col))
    return np.array(way)


@njit(cache=True)
def _pulled_tight(index, places, room):  # type: ignore[no-untyped-def]  # kernel
    """Which of (N, 2) places remain if each leads straight to the farthest that bisection finds in reach."""
    kept = [0]
    last = places.shape[0] - 1
    while kept[-1] < last:
        here = kept[-1]
        seen, unseen = here + 1, last + 1
        probe = last
        while unseen - seen > 1:
            if way_fits(index, places[here, 0], places[here, 1], places[probe, 0], places[probe, 1], room):
                seen = probe
            else:
                unseen = probe
            probe = (seen + unseen) // 2
        kept.append(seen)
    return np.array(kept)

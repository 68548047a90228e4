"""The map of a team against a slow one that is put together anew every time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.fleet import TILE_CELLS, TeamMap, Tile, TileCutter
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, GridWindow, MapFit, OccupancyGrid, Pose2

RESOLUTION_M = 0.05
SAME = MapFit.rigid(Pose2.identity())


class Maps:
    """A SLAM's map that a test draws."""

    def __init__(self, shape: tuple[int, int] = (100, 90), first: tuple[int, int] = (-37, 12)) -> None:
        self.cells = np.full(shape, UNKNOWN, dtype=np.int8)
        self.first = first
        self.windows: dict[int, GridWindow] = {}
        self.revision = 0
        self._grid: OccupancyGrid | None = None

    def draw(self, window: GridWindow, values: NDArray[np.int8]) -> None:
        self.cells = self.cells.copy()
        self.cells[window.slices] = values
        self.revision += 1
        self.windows[self.revision] = window
        self._grid = None

    def grow(self, by: int) -> None:
        self.cells = np.pad(self.cells, by, constant_values=UNKNOWN)
        self.first = (self.first[0] - by, self.first[1] - by)
        self.revision += 1
        self.windows.clear()
        self._grid = None

    def grid(self) -> OccupancyGrid:
        if self._grid is None:
            origin = (self.first[0] * RESOLUTION_M, self.first[1] * RESOLUTION_M)
            self._grid = OccupancyGrid(self.cells.copy(), RESOLUTION_M, origin, self.revision)
        return self._grid

    def changed_since(self, revision: int) -> GridWindow | None:
        later = [self.windows.get(number) for number in range(revision + 1, self.revision + 1)]
        if any(window is None for window in later):
            return None
        joined = GridWindow(0, 0, 0, 0)
        for window in later:
            assert window is not None
            joined = joined.joined(window)
        return joined


def slowly(own: OccupancyGrid, tiles: dict[tuple[str, tuple[int, int]], Tile]) -> dict[tuple[int, int], int]:
    """(column, row) on the lattice -> value, of all known cells."""
    known: dict[tuple[int, int], int] = {}
    for tile in sorted(tiles.values(), key=lambda tile: tile.revision):
        for row, col in np.argwhere(tile.cells != UNKNOWN):
            at = (tile.place[0] * TILE_CELLS + int(col), tile.place[1] * TILE_CELLS + int(row))
            known[at] = int(tile.cells[row, col])
    col0, row0 = (round(value / RESOLUTION_M) for value in own.origin_xy)
    for row, col in np.argwhere(own.cells != UNKNOWN):
        known[int(col) + col0, int(row) + row0] = int(own.cells[row, col])
    return known


def as_known(grid: OccupancyGrid) -> dict[tuple[int, int], int]:
    return slowly(grid, {})


def random_cells(rng: np.random.Generator, shape: tuple[int, ...]) -> NDArray[np.int8]:
    return rng.choice([UNKNOWN, FREE, OCCUPIED], shape).astype(np.int8)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 100_000))
def test_whatever_is_drawn_and_told_the_map_is_the_one_put_together_slowly(seed: int) -> None:
    rng = np.random.default_rng(seed)
    maps = Maps()
    team_map, told = TeamMap(maps), {}
    for sender in ("r0", "r1", "r2"):
        team_map.lay(sender, SAME)
    before = team_map.grid()
    for step in range(1, 12):
        what = rng.integers(4)
        if what == 0:
            maps.grow(int(rng.integers(1, 70)))
        elif what == 1:
            row, col = (int(rng.integers(0, size - 5)) for size in maps.cells.shape)
            window = GridWindow(row, col, row + int(rng.integers(1, 6)), col + int(rng.integers(1, 6)))
            maps.draw(window, random_cells(rng, (window.row1 - window.row0, window.col1 - window.col0)))
        else:
            place, who = (int(rng.integers(-2, 3)), int(rng.integers(-2, 3))), int(rng.integers(3))
            sender = f"r{who}"
            revision = 3 * (step if what == 2 else int(rng.integers(1, step + 1))) + who
            tile = Tile(revision, RESOLUTION_M, place, random_cells(rng, (TILE_CELLS, TILE_CELLS)))
            there = told.get((sender, place))
            assert team_map.put(sender, tile) == (there is None or there.revision < revision)
            if there is None or there.revision < revision:
                told[sender, place] = tile
        grid = team_map.grid()
        assert as_known(grid) == slowly(maps.grid(), told)
        window = team_map.changed_since(before.revision)
        if window is not None and grid.shape == before.shape and grid.origin_xy == before.origin_xy:
            outside = np.ones(grid.shape, dtype=np.bool_)
            outside[window.slices] = False
            assert np.array_equal(grid.cells[outside], before.cells[outside])
        before = grid


def test_alone_the_map_is_the_robots_own() -> None:
    maps = Maps()
    assert TeamMap(maps).grid() is maps.grid()


def test_the_map_is_the_same_object_while_nothing_changes() -> None:
    maps = Maps()
    team_map = TeamMap(maps)
    team_map.lay("bob", SAME)
    team_map.put("bob", Tile(1, RESOLUTION_M, (0, 0), np.zeros((TILE_CELLS, TILE_CELLS), dtype=np.int8)))
    assert team_map.grid() is team_map.grid()


@pytest.mark.parametrize("change", [{"resolution_m": 0.1}, {"cells": np.zeros((8, 8), dtype=np.int8)}])
def test_a_tile_of_other_cells_is_not_taken(change: dict[str, object]) -> None:
    tile = {"revision": 1, "resolution_m": 0.05, "place": (0, 0), "cells": np.zeros((64, 64), dtype=np.int8)}
    assert not TeamMap(Maps()).put("bob", Tile(**{**tile, **change}))  # type: ignore[arg-type]  # built from a table


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 100_000))
def test_tiles_cut_from_a_map_bring_a_mate_exactly_what_is_known(seed: int) -> None:
    rng = np.random.default_rng(seed)
    maps, cutter = Maps(), TileCutter()
    team_map, revision = TeamMap(Maps(shape=(10, 10), first=(500, 500))), -1
    team_map.lay("ada", SAME)
    for number in range(5):
        row, col = (int(rng.integers(0, size - 20)) for size in maps.cells.shape)
        maps.draw(GridWindow(row, col, row + 20, col + 20), random_cells(rng, (20, 20)))
        if number == 2:
            maps.grow(33)
        grid = maps.grid()
        window = None if revision < 0 else maps.changed_since(revision)
        for tile in cutter.changed(grid, window, number + 1):
            assert team_map.put("ada", tile)
        revision = grid.revision
        assert as_known(team_map.grid()) == as_known(grid)
    assert list(cutter.changed(maps.grid(), None, 99)) == [], "nothing is cut twice"


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 100_000), x=st.floats(-9, 9), y=st.floats(-9, 9), yaw=st.floats(-3.2, 3.2))
def test_a_cell_is_what_the_mate_has_at_its_centre_however_the_maps_lie(
    seed: int, x: float, y: float, yaw: float
) -> None:
    rng = np.random.default_rng(seed)
    T_ours_theirs = Pose2(x, y, yaw)
    team_map, tiles = TeamMap(Maps((10, 10))), {}
    team_map.lay("bob", MapFit.rigid(T_ours_theirs))
    for place in ((0, 0), (1, 0), (-3, 2)):
        tiles[place] = Tile(1, RESOLUTION_M, place, random_cells(rng, (TILE_CELLS, TILE_CELLS)))
        team_map.put("bob", tiles[place])
    grid = team_map.grid()
    cells = np.argwhere(np.ones(grid.shape, dtype=np.bool_))
    there = np.floor(T_ours_theirs.inverse().apply(grid.centers_of(cells)) / RESOLUTION_M + 1e-6).astype(int)
    for (row, col), (i, j) in zip(cells[::37].tolist(), there[::37].tolist(), strict=True):
        tile = tiles.get((i // TILE_CELLS, j // TILE_CELLS))
        expected = UNKNOWN if tile is None else tile.cells[j % TILE_CELLS, i % TILE_CELLS]
        assert grid.cells[row, col] == expected


def test_a_mate_whose_map_nobody_can_place_is_not_drawn_and_is_taken_out_again() -> None:
    maps = Maps()
    maps.draw(GridWindow(3, 3, 9, 9), np.full((6, 6), FREE, dtype=np.int8))
    team_map = TeamMap(maps)
    cells = np.full((TILE_CELLS, TILE_CELLS), OCCUPIED, dtype=np.int8)
    assert team_map.put("bob", Tile(1, RESOLUTION_M, (0, 0), cells))
    assert team_map.grid() is maps.grid()
    team_map.lay("bob", MapFit.rigid(Pose2(1.0, 0.0, 0.7)))
    assert len(as_known(team_map.grid())) > 0.9 * TILE_CELLS**2
    team_map.lay("bob", MapFit.rigid(Pose2(30.0, 0.0, 0.7)))
    theirs = as_known(team_map.grid()).keys() - as_known(maps.grid()).keys()
    assert min(col * RESOLUTION_M for col, _ in theirs) > 27.0
    team_map.lay("bob", None)
    assert as_known(team_map.grid()) == as_known(maps.grid())

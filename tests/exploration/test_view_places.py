from __future__ import annotations

import numpy as np

from explore_bt.exploration import Ground, Outlooks, Reach, ViewPlaces, clearance_field
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

RADIUS_M = 0.2
HERE_XY = (1.0, 3.0)


def hall() -> OccupancyGrid:
    """12 × 6 m of floor within walls, with an unknown corner far from ``HERE_XY``."""
    cells = np.full((60, 120), FREE, dtype=np.int8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    cells[50:59, 110:119] = UNKNOWN
    return OccupancyGrid(cells, 0.1, (0.0, 0.0))


def places(grid: OccupancyGrid, dense_m: float, more: np.ndarray | None = None) -> ViewPlaces:
    reach = Reach(Ground(grid), clearance_field(grid), HERE_XY, RADIUS_M)
    return ViewPlaces(reach, dense_m=dense_m, more=more)


def test_the_robot_can_stand_at_every_place_and_every_place_is_near_one() -> None:
    grid = hall()
    chosen = places(grid, 0.0)
    clearance_m = clearance_field(grid)
    assert clearance_m[tuple(grid.cells_of(chosen.xy).T)].min() >= RADIUS_M
    floor = grid.centers_of(np.argwhere(clearance_m >= 0.6))
    apart = np.hypot(*(floor[:, None] - chosen.xy[None]).transpose(2, 0, 1))
    assert apart.min(axis=1).max() < 0.6 * np.sqrt(2.0) + 0.1


def test_places_are_dense_round_about_the_robot_only() -> None:
    grid = hall()
    sparse, both = places(grid, 0.0), places(grid, 3.0)
    extra = both.xy[len(sparse.xy) :]
    np.testing.assert_array_equal(both.xy[: len(sparse.xy)], sparse.xy)
    away = np.hypot(*(extra - HERE_XY).T)
    assert away.max() <= 3.0
    assert len(extra) > 2.5 * np.count_nonzero(np.hypot(*(sparse.xy - HERE_XY).T) <= 3.0)


def test_further_places_count_where_the_robot_can_come_to_them() -> None:
    further = np.array([[2.0, 2.0], [0.05, 0.05], [99.0, 99.0]])
    grid = hall()
    assert len(places(grid, 0.0, further).xy) == len(places(grid, 0.0).xy) + 1


def test_spots_are_left_out_with_all_places_near_them() -> None:
    chosen = places(hall(), 3.0)
    spot = chosen.xy[0]
    others = chosen.without(spot[None])
    assert np.hypot(*(others.xy - spot).T).min() > 0.3
    assert len(chosen.xy) > len(others.xy)
    outlook, _, _ = others.look(Outlooks(), 5.0, 1.5, 0.05)
    assert len(outlook.begin) == len(others.xy) + 1


def test_a_dense_place_counts_only_near_a_frontier() -> None:
    grid = hall()
    chosen = places(grid, np.inf)
    outlook, _, _ = chosen.look(Outlooks(), 5.0, 1.5, 0.05)
    seen = np.diff(outlook.begin)
    corner_m = np.hypot(*(chosen.xy - (11.4, 5.4)).T)
    is_dense = np.arange(len(seen)) >= len(places(grid, 0.0).xy)
    assert seen[is_dense & (corner_m > 4.0)].max() == 0
    assert seen[~is_dense & (corner_m > 3.2) & (corner_m < 4.0)].max() > 0
    assert seen[is_dense & (corner_m < 1.2)].max() > 0

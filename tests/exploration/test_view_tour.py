from __future__ import annotations

import itertools

import numpy as np
import pytest

from explore_bt.exploration import (
    Ground,
    Outlooks,
    Reach,
    TourTaste,
    View,
    ViewPlaces,
    ViewSet,
    choose_views,
    clearance_field,
    first_run,
    order_views,
)
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

RADIUS_M, RANGE_M = 0.2, 5.0


def rooms(seed: int) -> OccupancyGrid:
    """Random boxes and random unknown patches on 12 × 9 m of floor; the middle is free."""
    rng = np.random.default_rng(seed)
    cells = np.full((90, 120), FREE, dtype=np.int8)
    for value, count, size in ((UNKNOWN, 12, 14), (OCCUPIED, 15, 10)):
        for _ in range(count):
            row, col = rng.integers(0, 90), rng.integers(0, 120)
            cells[row : row + rng.integers(2, size), col : col + rng.integers(2, size)] = value
    cells[42:48, 57:63] = FREE
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    return OccupancyGrid(cells, 0.1, (0.0, 0.0))


def chosen_in(grid: OccupancyGrid, taste: TourTaste) -> tuple[ViewPlaces, ViewSet]:
    places = ViewPlaces(Reach(Ground(grid), clearance_field(grid), (6.0, 4.5), RADIUS_M))
    return places, choose_views(places, Outlooks(), RANGE_M, taste)


@pytest.mark.parametrize("seed", range(6))
def test_views_show_different_cells_and_together_all_that_is_worth_it(seed: int) -> None:
    taste = TourTaste(most=100, horizon_m=100.0)
    places, chosen = chosen_in(rooms(seed), taste)
    outlook, cell_m2, _ = places.look(Outlooks(), RANGE_M, taste.depth_m, 0.5 * taste.min_gain_m2)
    seen = [set(outlook.cells[a:b].tolist()) for a, b in itertools.pairwise(outlook.begin)]
    at = dict(zip(map(tuple, places.xy.tolist()), seen, strict=True))
    covered: set[int] = set()
    for view in chosen.views:
        new = at[view.xy] - covered
        assert view.gain_m2 == pytest.approx(len(new) * cell_m2)
        assert view.gain_m2 >= taste.min_gain_m2
        covered |= new
    assert max(len(cells - covered) for cells in seen) * cell_m2 < taste.min_gain_m2
    worth = [cells for cells in seen if len(cells) * cell_m2 >= taste.min_gain_m2]
    assert chosen.total_m2 == pytest.approx(len(set().union(*worth)) * cell_m2)


def test_no_more_views_than_asked_for_and_none_beyond_the_horizon() -> None:
    near = chosen_in(rooms(1), TourTaste(most=3, horizon_m=4.0))[1]
    assert 0 < len(near.views) <= 3
    nearest_m = min(view.travel_m for view in near.views)
    assert max(view.travel_m for view in near.views) <= max(4.0, nearest_m + 10.0)


def test_where_nothing_is_unknown_there_is_no_view() -> None:
    grid = rooms(0)
    known = OccupancyGrid(np.where(grid.cells == UNKNOWN, np.int8(FREE), grid.cells), 0.1, (0.0, 0.0))
    chosen = chosen_in(known, TourTaste())[1]
    assert chosen.views == ()
    assert chosen.total_m2 == 0.0


def three_views() -> ViewSet:
    """Two on the right, one on the left, all two metres from the next."""
    xs = np.array([0.0, 2.0, 4.0, -2.0])
    views = tuple(View((x, 0.0), 1.0, abs(x), (0, 0)) for x in xs[1:].tolist())
    return ViewSet(views, np.abs(xs[:, None] - xs[None]), 3.0)


def test_the_order_is_the_shortest_unless_the_first_leg_costs_more() -> None:
    taste = TourTaste(haste=0.0, keep_m=1.0)
    free = order_views(three_views(), lambda _: 0.0, taste)
    assert [view.xy[0] for view in free] == [-2.0, 2.0, 4.0]
    turned = order_views(three_views(), lambda view: 3.0 if view.xy[0] < 0.0 else 0.0, taste)
    assert [view.xy[0] for view in turned] == [2.0, 4.0, -2.0]


def test_the_present_goal_is_kept_against_a_tour_not_clearly_shorter() -> None:
    slightly = TourTaste(haste=0.0, keep_m=1.0)
    firmly = TourTaste(haste=0.0, keep_m=2.5)
    assert order_views(three_views(), lambda _: 0.0, slightly, np.array([[2.0, 0.0]]))[0].xy[0] == -2.0
    assert order_views(three_views(), lambda _: 0.0, firmly, np.array([[2.0, 0.0]]))[0].xy[0] == 2.0


def spread(xys: list[tuple[float, float]]) -> ViewSet:
    """Views on an open floor around a robot at (0, 0), where ways are straight."""
    points = np.array([(0.0, 0.0), *xys])
    between = np.hypot(*(points[:, None] - points[None]).T)
    views = tuple(View(xy, 1.0, float(np.hypot(*xy)), (0, 0)) for xy in xys)
    return ViewSet(views, between, float(len(xys)))


def test_views_one_behind_another_are_one_run_and_those_aside_are_not() -> None:
    chosen = spread([(1.0, 0.1), (2.5, 0.0), (2.8, 2.0), (4.0, 2.0)])
    assert first_run(chosen, chosen.views, 0.5) == chosen.views[:2]
    assert first_run(chosen, chosen.views, 2.0) == chosen.views
    assert first_run(chosen, chosen.views, 0.0) == chosen.views[:1]


def test_a_run_does_not_turn_back() -> None:
    chosen = spread([(2.0, 0.0), (1.8, 1.0), (1.0, 1.0)])
    assert first_run(chosen, chosen.views, 5.0) == chosen.views[:1]


def worth(xy: tuple[float, float], gain_m2: float) -> View:
    return View(xy, gain_m2, float(np.hypot(*xy)), (0, 0))


def test_the_tour_begins_with_the_way_to_what_shows_most() -> None:
    """A scrap behind the robot is nearer; one on the way is not left for a second visit."""
    chosen = spread([(-1.5, 0.0), (2.0, 0.5), (5.0, 0.0)])
    scrap, on_the_way = worth((-1.5, 0.0), 0.2), worth((2.0, 0.5), 0.2)
    hall = worth((5.0, 0.0), 9.0)
    views = ViewSet((scrap, on_the_way, hall), chosen.between_m, 9.4)
    taste = TourTaste(haste=0.0, aside_m=1.0)
    assert order_views(views, lambda _: 0.0, taste) == (on_the_way, hall, scrap)
    assert order_views(views, lambda _: 0.0, TourTaste(haste=0.0, aside_m=5.0))[0] == scrap
    closet = ViewSet((scrap, on_the_way, worth((5.0, 0.0), 2.0)), chosen.between_m, 2.4)
    assert order_views(closet, lambda _: 0.0, taste)[0] == scrap


def test_a_run_ends_where_the_present_one_does() -> None:
    chosen = spread([(1.0, 0.0), (2.0, 0.0), (3.0, 0.0)])
    assert first_run(chosen, chosen.views, 0.5, end_xy=(2.0, 0.0)) == chosen.views[:2]
    assert first_run(chosen, chosen.views, 0.5, end_xy=(2.0, 3.0)) == chosen.views


@pytest.mark.parametrize("seed", range(20))
def test_no_run_is_longer_than_the_way_straight_to_its_end_and_the_detour(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chosen = spread([(float(x), float(y)) for x, y in rng.uniform(-3.0, 3.0, (8, 2))])
    order = [chosen.views[k] for k in rng.permutation(8)]
    run = first_run(chosen, order, 0.7)
    assert list(run) == order[: len(run)]
    way = np.array([(0.0, 0.0), *(view.xy for view in run)])
    legs = np.diff(way, axis=0)
    assert np.hypot(*legs.T).sum() <= np.hypot(*way[-1]) + 0.7 + 1e-9
    assert (np.einsum("ij,ij->i", legs[:-1], legs[1:]) >= -1e-9).all()

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import UserError
from explore_bt.exploration import gain_many, visible_unknown_area
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

from .grids import drawn, random_cells


def cells_on(u, v, du, dv, reach):
    """(entry, leave, row, col) of the cells a ray crosses, by clipping it against every cell around."""
    size = math.ceil(reach) + 2
    crossed = []
    for row in range(math.floor(v) - size, math.floor(v) + size + 1):
        for col in range(math.floor(u) - size, math.floor(u) + size + 1):
            low, high = 0.0, math.inf
            for position, step, edge in ((u, du, col), (v, dv, row)):
                if step == 0:
                    low, high = (low, high) if edge <= position < edge + 1 else (1.0, 0.0)
                else:
                    ends = sorted(((edge - position) / step, (edge + 1 - position) / step))
                    low, high = max(low, ends[0]), min(high, ends[1])
            if high - low > 1e-12 and low <= reach:
                crossed.append((low, high, row, col))
    return sorted(crossed)


def area_by_clipping(grid, xy, range_m, fov, heading, depth_m):
    reach, depth = range_m / grid.resolution_m, depth_m / grid.resolution_m
    u, v = ((p - o) / grid.resolution_m for p, o in zip(xy, grid.origin_xy, strict=True))
    ring = math.ceil(reach) + 1
    row0, col0 = math.floor(v), math.floor(u)
    targets = {
        (row0 + i, col0 + j)
        for i in range(-ring, ring + 1)
        for j in range(-ring, ring + 1)
        if max(abs(i), abs(j)) == ring
    }
    seen = set()
    for row, col in targets:
        angle = math.atan2(row + 0.5 - v, col + 0.5 - u)
        if fov < 2 * math.pi and abs(math.remainder(angle - heading, 2 * math.pi)) > fov / 2:
            continue
        passed = 0.0
        for low, high, r, c in cells_on(u, v, math.cos(angle), math.sin(angle), reach):
            value = grid.cells[r, c] if grid.contains_cell(r, c) else UNKNOWN
            if value == OCCUPIED or (value == UNKNOWN and passed >= depth):
                break
            if value == UNKNOWN:
                passed += high - low
                if math.hypot(r + 0.5 - v, c + 0.5 - u) <= reach:
                    seen.add((r, c))
    return len(seen) * grid.resolution_m**2


@settings(deadline=None, max_examples=40)
@given(
    random_cells(9),
    st.sampled_from([0.313, 1.127, 3.471, 6.877]),
    st.sampled_from([0.291, 2.837, 5.6173]),
    st.sampled_from([1.9, 3.3]),
    st.sampled_from([2 * math.pi, 1.234]),
    st.floats(-3, 3),
    st.sampled_from([math.inf, 1.35]),
)
def test_the_area_is_what_clipping_every_ray_against_every_cell_gives(
    cells, u, v, reach, fov, heading, depth
):
    grid = OccupancyGrid(cells, 0.2, (-1.0, 2.0))
    xy = (-1.0 + u * 0.2, 2.0 + v * 0.2)
    expected = area_by_clipping(grid, xy, reach * 0.2, fov, heading, depth * 0.2)
    found = visible_unknown_area(grid, xy, reach * 0.2, fov, heading, depth_m=depth * 0.2)
    assert found == pytest.approx(expected)


@settings(deadline=None, max_examples=30)
@given(st.floats(0, 1), st.floats(0, 1), st.floats(0.3, 2.0))
def test_in_the_unknown_every_cell_in_range_counts_once(x, y, range_m):
    grid = OccupancyGrid(np.full((1, 1), UNKNOWN, np.int8), 0.05, (0.0, 0.0))
    rows, cols = np.mgrid[-50:80, -50:80]
    inside = np.hypot((cols + 0.5) * 0.05 - x, (rows + 0.5) * 0.05 - y) <= range_m
    edge = np.abs(np.hypot((cols + 0.5) * 0.05 - x, (rows + 0.5) * 0.05 - y) - range_m) < 1e-9
    found = round(visible_unknown_area(grid, (x, y), range_m) / 0.05**2)
    assert abs(found - inside.sum()) <= edge.sum()


def test_a_closed_room_shows_nothing_new():
    cells = np.full((40, 40), UNKNOWN, np.int8)
    cells[10:30, 10:30] = OCCUPIED
    cells[11:29, 11:29] = FREE
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    assert visible_unknown_area(grid, (2.0, 2.0), 5.0) == 0.0


def test_nothing_is_seen_from_inside_a_wall():
    assert visible_unknown_area(drawn("???\n?#?\n???"), (0.15, 0.15), 1.0) == 0.0


def test_many_places_give_what_each_gives_alone():
    rng = np.random.default_rng(4)
    grid = OccupancyGrid(
        rng.choice([FREE, FREE, UNKNOWN, OCCUPIED], (50, 50)).astype(np.int8), 0.05, (0.0, 0.0)
    )
    points = rng.uniform(0, 2.5, (20, 2))
    headings = rng.uniform(-3, 3, 20)
    many = gain_many(grid, points, 0.8, fov_rad=2.0, heading_rad=headings)
    alone = [visible_unknown_area(grid, tuple(p), 0.8, 2.0, h) for p, h in zip(points, headings, strict=True)]
    assert many.tolist() == alone


def test_a_bounded_depth_counts_a_pinhole_by_its_width():
    cells = np.full((60, 120), UNKNOWN, np.int8)
    cells[10:50, 10:50] = OCCUPIED
    cells[11:49, 11:49] = FREE
    cells[30, 49] = FREE  # the hole
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    unbounded = visible_unknown_area(grid, (2.0, 1.52), 4.0)
    assert visible_unknown_area(grid, (2.0, 1.52), 4.0, depth_m=0.5) < 0.3 * unbounded


def test_a_range_of_nothing_is_refused():
    with pytest.raises(UserError, match="range_m: 0"):
        visible_unknown_area(drawn("..?"), (0.05, 0.05), 0.0)

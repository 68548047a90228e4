import math
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.world import (
    World,
    choose_start,
    fitting_cells,
    load_world,
    observable_floor,
    read_world_file,
)
from explore_bt_drivers.world.index import build_index, cast_rays, nearest
from explore_bt_drivers.world.observable import reachable_cells
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.errors import WorldError
from explore_bt.maps import write_map
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

APARTMENT = Path(__file__).parents[2] / "missions" / "worlds" / "apartment.yaml"


def slow_cast(segments: NDArray[np.float64], x: float, y: float, angle: float, limit: float) -> float:
    """Every segment against the ray as two linear equations, no index."""
    best = math.inf
    for ax, ay, bx, by in segments:
        matrix = np.array([[math.cos(angle), ax - bx], [math.sin(angle), ay - by]])
        if abs(np.linalg.det(matrix)) < 1e-12:
            continue
        t, u = np.linalg.solve(matrix, [ax - x, ay - y])
        if t >= 0.0 and -1e-9 <= u <= 1.0 + 1e-9:
            best = min(best, t)
    return best if best <= limit else math.inf


def slow_cast_cells(grid: OccupancyGrid, x: float, y: float, angle: float, limit: float) -> float:
    """The ray against the square of every solid cell (slabs), and against the outside of the grid."""
    step = np.array([math.cos(angle), math.sin(angle)])
    step[np.abs(step) < 1e-15] = 1e-15
    rows, cols = np.nonzero(~grid.free)
    low = np.column_stack((cols, rows)) * grid.resolution_m + np.asarray(grid.origin_xy)
    one, other = (low - [x, y]) / step, (low + grid.resolution_m - [x, y]) / step
    enter, leave = np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
    hits = enter[(enter <= leave) & (leave >= 0.0)]
    edge = np.asarray(grid.origin_xy) + np.where(step > 0, grid.shape[::-1], 0) * grid.resolution_m
    best = min([*hits.tolist(), *((edge - [x, y]) / step).tolist()])
    return best if best <= limit else math.inf


def save_map(folder: Path, cells: NDArray[np.int8], resolution_m: float = 0.1) -> World:
    grid = OccupancyGrid(cells, resolution_m, (-1.3, 0.7))
    return load_world(write_map(grid, folder)[1])


MICROMETRES = st.integers(-4_000_000, 4_000_000).map(lambda count: count * 1e-6)
BESIDE = MICROMETRES.map(lambda metres: metres + 3.3e-7)  # a robot's centre never lies in a wall's very line


@settings(deadline=None, max_examples=60)
@given(
    corners=st.lists(st.tuples(*[MICROMETRES] * 4), min_size=1, max_size=12),
    x=BESIDE,
    y=BESIDE,
    angle=st.floats(-math.pi, math.pi),
)
def test_rays_meet_what_a_search_over_all_segments_meets(
    corners: list[tuple[float, float, float, float]], x: float, y: float, angle: float
) -> None:
    frame = [(-5.0, -5.0, 5.0, -5.0), (5.0, 5.0, -5.0, 5.0)]
    segments = np.array([c for c in corners if math.dist(c[:2], c[2:]) > 1e-3] + frame)
    expected = slow_cast(segments, x, y, angle, 5.0)
    found = cast_rays(build_index(segments), x, y, np.array([angle]), 5.0)[0]
    # a ray within rounding of an end or of the limit may be judged either way
    near = min(slow_cast(segments, x, y, angle + turn, 5.0 + 1e-6) for turn in (1e-7, -1e-7))
    assert found == pytest.approx(expected, abs=1e-6) or found == pytest.approx(near, abs=1e-3)


def test_rays_in_a_furnished_flat_are_exact() -> None:
    plan, world = read_world_file(APARTMENT), load_world(APARTMENT)
    segments = np.concatenate([np.hstack((s.corners, np.roll(s.corners, -1, axis=0))) for s in plan.solids])
    angles = np.linspace(-math.pi, math.pi, 60)
    for x, y in [(3.3, 3.6), (8.0, 4.4), (9.9, 5.8)]:
        expected = [slow_cast(segments, x, y, angle, 5.0) for angle in angles]
        assert world.cast(x, y, angles, 5.0) == pytest.approx(expected, abs=1e-9)


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), share=st.floats(0.0, 0.5), angle=st.floats(-math.pi, math.pi))
def test_rays_in_a_map_meet_the_very_cells(
    seed: int, share: float, angle: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    rng = np.random.default_rng(seed)
    cells = rng.choice(
        np.array([FREE, OCCUPIED, UNKNOWN], np.int8), (14, 11), p=[1 - share, share / 2, share / 2]
    )
    row, col = int(rng.integers(14)), int(rng.integers(11))
    cells[row, col] = FREE
    world = save_map(tmp_path_factory.mktemp("map"), cells)
    x, y = -1.3 + (col + rng.uniform(0.1, 0.9)) * 0.1, 0.7 + (row + rng.uniform(0.1, 0.9)) * 0.1
    grid = OccupancyGrid(cells, 0.1, (-1.3, 0.7))
    assert world.cast(x, y, np.array([angle]), 0.6)[0] == pytest.approx(
        slow_cast_cells(grid, x, y, angle, 0.6), abs=1e-9
    )


def test_no_ray_slips_through_the_corner_between_two_cells(tmp_path: Path) -> None:
    cells = np.full((9, 9), FREE, dtype=np.int8)
    cells[np.arange(9), np.arange(9)[::-1]] = OCCUPIED  # a chain of cells that only share corners
    world = save_map(tmp_path, cells, 1.0)
    corners = np.array([(k - 0.5, 8.5 - k) for k in range(1, 9)])
    for x, y in corners:
        angle, distance = math.atan2(y, x), math.hypot(x, y)
        assert world.cast(-0.8, 1.2, np.array([angle]), 20.0)[0] <= distance + 1e-9


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), x=st.floats(-3, 6), y=st.floats(-3, 6))
def test_the_nearest_segment_is_the_nearest_of_all(seed: int, x: float, y: float) -> None:
    rng = np.random.default_rng(seed)
    segments = rng.uniform(-2, 5, (int(rng.integers(1, 15)), 4))
    a, u = segments[:, :2], segments[:, 2:] - segments[:, :2]
    t = np.clip(((np.array([x, y]) - a) * u).sum(axis=1) / (u * u).sum(axis=1), 0.0, 1.0)
    expected = np.hypot(*(a + t[:, None] * u - [x, y]).T).min()
    assert nearest(build_index(segments), x, y, math.inf)[0] == pytest.approx(expected, abs=1e-9)
    assert nearest(build_index(segments), x, y, 0.5)[0] == pytest.approx(min(expected, 0.5), abs=1e-9)


def test_outside_a_map_and_on_its_grey_cells_everything_is_solid(tmp_path: Path) -> None:
    cells = np.full((10, 10), FREE, dtype=np.int8)
    cells[5, 5] = UNKNOWN
    world = save_map(tmp_path, cells)
    assert world.is_free(-1.25, 0.75)
    assert not world.is_free(-1.35, 0.75)
    assert world.clearance_m(-1.3 + 0.55, 0.7 + 0.55) == 0.0
    assert world.cast(-1.25, 0.75, np.array([math.pi]), 5.0)[0] == pytest.approx(0.05)


def test_fitting_cells_keep_the_radius_from_everything() -> None:
    world = load_world(APARTMENT)
    fitting = fitting_cells(world, 0.25)
    rng = np.random.default_rng(0)
    for row, col in rng.choice(np.argwhere(world.floor.free), 300):
        assert fitting[row, col] == (world.clearance_m(*world.floor.center_of(row, col)) >= 0.25 - 1e-6)


def test_without_a_start_it_is_the_widest_place_of_the_largest_piece_of_floor(tmp_path: Path) -> None:
    cells = np.full((80, 160), OCCUPIED, dtype=np.int8)
    cells[2:22, 2:150] = FREE  # a corridor with a bay
    cells[2:28, 100:126] = FREE
    cells[40:75, 2:37] = FREE  # a hall that nobody comes to
    world = save_map(tmp_path, cells)
    start = choose_start(world, None, 0.25)
    row, col = world.floor.cell_of(start.x, start.y)
    assert 13 <= row <= 15
    assert 108 <= col <= 118
    too_wide_for_the_corridor = choose_start(world, None, 1.5)
    assert world.floor.cell_of(*too_wide_for_the_corridor.xy) == (57, 19)


def test_a_passage_narrower_than_the_robot_ends_its_reach(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    text = "format: explore-bt-world/1\nrooms: [{name: a, box: [0, 0, 3, 3]}, {name: b, box: [3, 0, 6, 3]}]\n"
    for width, joined in [(0.49, False), (0.6, True)]:
        path.write_text(text + f"doors: [{{at: [3, 1.5], width: {width}}}]\n")
        world = load_world(path)
        reached = reachable_cells(world, (1.0, 1.0), 0.25)
        assert reached[world.floor.cell_of(4.5, 1.5)] == joined


def slow_observable(world: World, reachable: NDArray[np.bool_], range_m: float) -> NDArray[np.bool_]:
    """Cells whose centre is seen by an exact ray from some reachable cell."""
    seen = np.zeros_like(reachable)
    targets = np.argwhere(world.floor.free)
    places = world.floor.centers_of(np.argwhere(reachable)[::7])
    for (row, col), point in zip(targets, world.floor.centers_of(targets), strict=True):
        away = point - places
        for (dx, dy), (x, y) in zip(away, places, strict=True):
            distance = math.hypot(dx, dy)
            if (
                distance <= range_m
                and world.cast(x, y, np.array([math.atan2(dy, dx)]), distance)[0] > distance
            ):
                seen[row, col] = True
                break
    return seen


def test_observable_floor_is_what_exact_rays_from_reachable_places_see(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(
        "format: explore-bt-world/1\nrooms: [{name: a, box: [0, 0, 2, 2]}, {name: b, box: [2, 0, 4, 2]}]\n"
        "doors: [{at: [2, 1.0], width: 30 cm}]\nfurniture: [{name: box, box: [0.9, 1.1, 1.2, 1.4]}]\n"
    )
    world = load_world(path)
    floor = observable_floor(world, (0.5, 0.5), 0.25, 1.5)
    expected = slow_observable(world, reachable_cells(world, (0.5, 0.5), 0.25), 1.5)
    assert set(np.unique(floor.cells)) <= {FREE, UNKNOWN}
    assert not floor.free[~world.floor.free].any()
    assert (floor.free != expected).sum() < 0.06 * expected.sum()  # border cells: 0.3 m spacing, centres


def test_a_room_without_an_entrance_is_not_observable(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(
        "format: explore-bt-world/1\nrooms: [{name: a, box: [0, 0, 3, 3]}, {name: b, box: [3, 0, 6, 3]}]\n"
    )
    world = load_world(path)
    floor = observable_floor(world, (1.0, 1.0), 0.25, 5.0)
    assert floor.free.sum() == pytest.approx(58 * 58, rel=0.001)
    assert not floor.free[:, 62:].any()


def test_a_map_whose_resolution_makes_it_huge_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match="the world is 900 m by 900 m, more than"):
        save_map(tmp_path, np.full((9, 9), FREE, dtype=np.int8), 100.0)


def test_a_map_without_a_free_cell_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match="has no free floor; everything is solid or unknown"):
        save_map(tmp_path, np.full((9, 9), UNKNOWN, dtype=np.int8))

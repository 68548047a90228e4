import numpy as np
from explore_bt_controllers.nearby import Nearby
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import Surroundings
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, MovingObstacle, OccupancyGrid

CELL = 0.04


def floor(resolution=0.05, size=8.0):
    count = round(size / resolution)
    return np.full((count, count), FREE, dtype=np.int8), resolution, (-size / 2, -size / 2)


def room_around(surroundings, at):
    nearby = Nearby()
    nearby.see(surroundings)
    return nearby.room_at(np.atleast_2d(at), 0.0, 0.0)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10_000), st.sampled_from([0.05, 0.1]))
def test_room_is_the_distance_to_the_nearest_point_to_a_cell(seed, resolution):
    rng = np.random.default_rng(seed)
    points, at = rng.uniform(-1.5, 1.5, (30, 2)), rng.uniform(-1.0, 1.0, (20, 2))
    room = room_around(Surroundings(0.0, points, OccupancyGrid(*floor(resolution))), at)
    exact = np.hypot(*(at[:, None, :] - points[None]).transpose(2, 0, 1)).min(axis=1)
    assert np.abs(room - exact).max() <= 2.0 * 0.5 * np.sqrt(2.0) * CELL + 1e-6


def test_the_same_surroundings_have_the_same_field_to_the_last_bit():
    rng = np.random.default_rng(0)
    points = rng.uniform(-2.0, 2.0, (60, 2))
    grid = OccupancyGrid(*floor())
    fields, kept = set(), []
    for _ in range(200):
        kept.append(np.empty(int(rng.integers(1, 5000)), dtype=np.uint8))  # elsewhere in memory
        nearby = Nearby()
        nearby.see(Surroundings(0.0, points.copy(), grid))
        fields.add(nearby.field(0.0, 0.0).room.tobytes())
    assert len(fields) == 1


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10_000))
def test_the_field_is_the_exact_distance_between_cells(seed):
    points = np.random.default_rng(seed).uniform(-2.3, 2.3, (seed % 12, 2))
    nearby = Nearby()
    nearby.see(Surroundings(0.0, points, OccupancyGrid(*floor())))
    room = nearby.field(0.0, 0.0).room
    taken = np.floor((points + 2.4) / CELL).astype(int)
    row, col = np.indices(room.shape)
    exact = np.full(room.shape, 100.0)
    for x, y in taken:
        exact = np.minimum(exact, CELL * np.hypot(row - y, col - x))
    assert np.allclose(room, exact, atol=1e-5)


def test_what_is_not_known_is_an_obstacle_and_so_is_what_only_the_map_shows():
    cells, resolution, origin = floor()
    cells[:, 100:] = UNKNOWN  # x > 1
    cells[60, 80] = OCCUPIED  # (0, -1)
    nothing = np.empty((0, 2))
    room = room_around(
        Surroundings(0.0, nothing, OccupancyGrid(cells, resolution, origin)), [(0.5, 0.0), (0.0, -0.7)]
    )
    assert np.allclose(room, [0.5, 0.25], atol=1.5 * CELL)


def test_a_cell_of_the_map_gives_way_to_the_points_that_show_the_same_thing():
    cells, resolution, origin = floor()
    cells[:, 100:102] = OCCUPIED  # a wall drawn two cells thick, 1.0 to 1.1
    y = np.arange(-3.0, 3.0, 0.02)
    points = np.column_stack((np.full(y.size, 1.09), y))
    surroundings = Surroundings(0.0, points, OccupancyGrid(cells, resolution, origin))
    assert abs(room_around(surroundings, (0.5, 0.0))[0] - 0.59) <= CELL


def test_what_moves_is_not_in_the_field_but_where_it_will_be():
    cells, resolution, origin = floor()
    cells[78:83, 98:103] = OCCUPIED  # smeared into the map
    angle = np.linspace(0.0, 6.0, 40)
    points = np.column_stack((1.0 + 0.2 * np.cos(angle), 0.2 * np.sin(angle)))
    person = MovingObstacle(1, (1.0, 0.0), (-0.5, 0.2), 0.2, 10.0)
    nearby = Nearby()
    nearby.see(Surroundings(10.0, points, OccupancyGrid(cells, resolution, origin), (person,)))
    assert nearby.room_at(np.array([[1.0, 0.0]]), 0.0, 0.0)[0] > 1.0
    times = np.array([10.0, 11.0, 12.0])
    moving = nearby.moving_at(times, 0.35, 0.4, 0.3)
    assert np.allclose(moving[:, 0, :2], [person.at(time) for time in times])
    assert np.allclose(moving[:, 0, 2], 0.55)
    assert np.allclose(moving[:, 0, 3], [0.4, 0.7, 1.0])

import itertools

import numpy as np
import pytest

from explore_bt.errors import WorldError
from explore_bt.evaluation import spread_starts
from explore_bt.exploration import clearance_field, travel_field
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid


def two_rooms(joined=True):
    cells = np.full((60, 120), FREE, dtype=np.int8)
    cells[:, 59:61] = OCCUPIED
    if joined:
        cells[20:40, 59:61] = FREE
    return OccupancyGrid(cells, 0.05, (1.0, -2.0))


@pytest.mark.parametrize("seed", range(5))
def test_starts_have_room_are_joined_and_far_apart(seed):
    floor = two_rooms()
    clearance = clearance_field(floor)
    starts = spread_starts(floor, 0.2, 4, seed)
    assert len(starts) == 4
    for start in starts:
        assert clearance[floor.cell_of(*start.xy)] >= 0.5
    field = travel_field(clearance, floor.cell_of(*starts[0].xy), 0.2, 0.05)
    assert all(np.isfinite(field[floor.cell_of(*start.xy)]) for start in starts)
    assert min(a.distance_to(b) for a, b in itertools.combinations(starts, 2)) > 0.8


def test_starts_follow_the_seed_and_a_longer_list_begins_with_a_shorter_one():
    floor = two_rooms()
    places = {seed: [start.xy for start in spread_starts(floor, 0.2, 4, seed)] for seed in range(3)}
    assert places[0] == [start.xy for start in spread_starts(floor, 0.2, 4, 0)]
    assert places[0][:2] == [start.xy for start in spread_starts(floor, 0.2, 2, 0)]
    assert places[0] != places[1]


def test_starts_stay_in_the_largest_part():
    floor = two_rooms(joined=False)
    sides = {start.x > 1.0 + 3.0 for start in spread_starts(floor, 0.2, 4, 1)}
    assert len(sides) == 1


def test_a_floor_too_tight_is_refused():
    with pytest.raises(WorldError, match="wide enough"):
        spread_starts(two_rooms(), 3.0, 4, 0)

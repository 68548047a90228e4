"""Floor that may hide someone, against people who walk about unseen as cleverly as they can."""

import numpy as np
import pytest

from explore_bt.exploration import scan_of_grid
from explore_bt.runtime.hidden import STROLL_MPS, HiddenFloor
from explore_bt.runtime.sight import Sight
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid, Pose2, Twist2

CELL = 0.05


def two_rooms() -> OccupancyGrid:
    """Rooms of 3 x 3 m side by side, a door of 0.9 m in the wall at x = 0 between them, about y = 0."""
    cells = np.full((70, 130), OCCUPIED, dtype=np.int8)
    cells[5:65, 5:64] = FREE
    cells[5:65, 66:125] = FREE
    cells[26:44, 64:66] = FREE
    return OccupancyGrid(cells, CELL, (-3.25, -1.75))


def sight_from(grid: OccupancyGrid, pose: Pose2, stamp_s: float) -> Sight:
    scan = scan_of_grid(grid, pose, 5.0, stamp_s=stamp_s)
    sight = Sight.of(scan, pose, Twist2())
    assert sight is not None
    return sight


def test_behind_the_wall_beside_a_door_someone_may_stand() -> None:
    grid = two_rooms()
    places = HiddenFloor().see(grid, sight_from(grid, Pose2(-1.5, 0.0, 0.0), 0.0))
    assert len(places)
    assert (places[:, 0] > 0.1).all()
    assert (np.abs(places[:, 1]) > 0.2).all()


def test_a_room_in_full_sight_hides_nobody() -> None:
    grid = two_rooms()
    floor = HiddenFloor()
    floor.see(grid, sight_from(grid, Pose2(1.5, 0.0, 0.0), 0.0))
    places = floor.see(grid, sight_from(grid, Pose2(1.5, 0.0, 0.0), 0.1))
    assert (places[:, 0] < 0.0).all()


def test_floor_that_was_in_sight_is_clear_until_someone_can_have_walked_there() -> None:
    """From the doorway both rooms are seen; back in one, nobody can have come into the other."""
    grid = two_rooms()
    floor = HiddenFloor()
    for i, x in enumerate((-1.5, -0.7, 0.0, -0.7, -1.5)):
        places = floor.see(grid, sight_from(grid, Pose2(x, 0.0, 0.0), 0.5 * i))
    assert len(places) == 0


@pytest.mark.parametrize("seed", range(8))
def test_nobody_who_keeps_out_of_sight_leaves_the_hidden_floor(seed: int) -> None:
    """People begin anywhere unseen and wander; as long as no beam shows them they are where it says."""
    grid, rng = two_rooms(), np.random.default_rng(seed)
    floor, robot = HiddenFloor(), np.array([-2.0, 0.0])
    people = rng.uniform((-3.0, -1.5), (3.0, 1.5), (4000, 2))
    people, asked = people[has_room(people)], 0
    for step in range(40):
        robot = np.clip(robot + rng.uniform(-0.05, 0.05, 2), (-2.5, -1.0), (-1.7, 1.0))
        course = rng.uniform(0.0, 2.0 * np.pi, len(people))
        there = people + STROLL_MPS * 0.1 * np.column_stack((np.cos(course), np.sin(course)))
        people = np.where(has_room(there)[:, None], there, people)
        sight = sight_from(grid, Pose2(*robot.tolist(), 0.0), 0.1 * step)
        floor.see(grid, sight)
        people = people[is_hidden(sight, people)]
        ruled_out = [place for place in people if not floor.may_hide(place)]
        assert not ruled_out
        asked += len(people)
    assert asked > 500


def has_room(places: np.ndarray) -> np.ndarray:
    x, y = np.abs(places).T
    body = 0.27
    in_a_room = (x > 0.05 + body) & (x < 3.0 - body) & (y < 1.5 - body)
    return in_a_room | ((x < 0.4) & (y < 0.45 - body))


def is_hidden(sight: Sight, places: np.ndarray) -> np.ndarray:
    turns = np.arange(0.0, 2.0 * np.pi, 0.2)
    body = np.vstack([r * np.column_stack((np.cos(turns), np.sin(turns))) for r in (0.0, 0.1, 0.2, 0.3)])
    shown = sight.shows((places[:, None] + body).reshape(-1, 2)).reshape(len(places), len(body))
    return ~shown.any(axis=1)

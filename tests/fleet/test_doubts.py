"""What speaks against maps that seem to fit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from explore_bt.fleet import TileCutter, Unseen, quarrel
from explore_bt.fleet.mosaic import Mosaic
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, MapFit, Mate, OccupancyGrid, Pose2, Scan2D, Twist2

SIZE_M = 0.05


def room(*walls: tuple[slice, slice]) -> OccupancyGrid:
    """8 by 6 m with a table, and more walls."""
    cells = np.full((120, 160), FREE, dtype=np.int8)
    cells[:2], cells[-2:], cells[:, :2], cells[:, -2:] = OCCUPIED, OCCUPIED, OCCUPIED, OCCUPIED
    cells[40:60, 100:110] = OCCUPIED
    for wall in walls:
        cells[wall] = OCCUPIED
    return OccupancyGrid(cells, SIZE_M, (0.0, 0.0), 1)


def seen(grid: OccupancyGrid, T_ours_theirs: Pose2) -> Mosaic:
    mosaic = Mosaic(SIZE_M)
    for tile in TileCutter().changed(grid, None, 1):
        mosaic.put(tile)
    mosaic.lay(MapFit.rigid(T_ours_theirs))
    return mosaic


def test_maps_that_fit_do_not_quarrel() -> None:
    assert quarrel(room(), seen(room(), Pose2.identity())) == ""
    assert quarrel(room(), seen(room(), Pose2(0.1, -0.1, 0.02))) == "", "nor when they are a little off"


def test_a_door_that_was_shut_meanwhile_is_no_quarrel() -> None:
    door = (slice(60, 62), slice(30, 48))
    assert quarrel(room(door), seen(room(), Pose2.identity())) == ""
    assert quarrel(room(), seen(room(door), Pose2.identity())) == ""


@pytest.mark.parametrize("T", [Pose2(1.5, 0.0, 0.0), Pose2(2.0, 0.5, math.pi / 3), Pose2(8.0, 6.0, math.pi)])
def test_maps_that_do_not_fit_quarrel(T: Pose2) -> None:
    wall = (slice(60, 62), slice(2, 80))
    assert "of wall" in quarrel(room(wall), seen(room(wall), T))


def test_maps_that_do_not_touch_do_not_quarrel() -> None:
    assert quarrel(room(), seen(room(), Pose2(30.0, 0.0, 0.0))) == ""
    blank = replace(room(), cells=np.full((120, 160), UNKNOWN, dtype=np.int8))
    assert quarrel(room(), seen(blank, Pose2.identity())) == ""


def mate(x: float, y: float) -> Mate:
    at = np.array([[x, y]])
    return Mate("bob", 0.0, 0.05, Pose2(x, y, 0.0), Twist2(), 0.25, 0.5, at, np.empty((0, 2)))


def scan(shown: tuple[float, float] | None, wall_m: float = 4.5) -> Scan2D:
    """From the origin: a round wall, and a body where one is shown."""
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False).astype(np.float32)
    ranges = np.full(360, wall_m, dtype=np.float32)
    if shown is not None:
        away = math.hypot(*shown)
        off = np.abs((angles - math.atan2(shown[1], shown[0]) + np.pi) % (2 * np.pi) - np.pi)
        ranges[off < math.asin(0.25 / away)] = away - 0.2
    return Scan2D(
        stamp_s=0.0,
        frame="lidar",
        angles_rad=angles,
        ranges_m=ranges,
        times_s=np.zeros(360, np.float32),
        range_min_m=0.05,
        range_max_m=5.0,
        T_base_sensor=Pose2.identity(),
    )


def verdict(seen_by_lidar: Scan2D, where: Mate, scans: int = 15) -> dict[str, str]:
    unseen, found = Unseen(), {}
    for _ in range(scans):
        found |= unseen.look(seen_by_lidar, Pose2.identity(), [where], 0.25)
    return found


def test_who_stands_where_it_says_is_believed() -> None:
    assert verdict(scan((2.0, 1.0)), mate(2.0, 1.0)) == {}
    assert verdict(scan((2.0, 1.0)), mate(2.1, 0.9)) == {}


def test_who_is_looked_right_through_is_not_but_only_after_a_row_of_scans() -> None:
    assert verdict(scan(None), mate(2.0, 1.0), scans=14) == {}
    assert "2.2 m away, and nothing stands there" in verdict(scan(None), mate(2.0, 1.0))["bob"]


def test_who_would_stand_in_the_middle_of_this_robot_is_not_believed() -> None:
    assert "bob" in verdict(scan(None), mate(0.1, 0.0))


def test_behind_a_wall_or_far_off_nothing_can_be_said() -> None:
    assert verdict(scan(None, wall_m=1.0), mate(2.0, 1.0)) == {}
    assert verdict(scan(None), mate(4.0, 1.0)) == {}

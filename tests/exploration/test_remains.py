from __future__ import annotations

import numpy as np
import pytest

from explore_bt.exploration import clearance_field, sentences, travel_field, what_remains
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid


def two_rooms(gap_cells: int) -> OccupancyGrid:
    """A known room, and through a gap in its wall a half known one."""
    cells = np.full((40, 80), UNKNOWN, dtype=np.int8)
    cells[5:35, 5:60] = FREE
    cells[4, :62] = cells[35, :62] = cells[4:36, 4] = OCCUPIED
    cells[5:35, 40] = OCCUPIED
    cells[20 : 20 + gap_cells, 40] = FREE
    return OccupancyGrid(cells, 0.05, (0.0, 0.0))


def remains(grid: OccupancyGrid) -> tuple[tuple[tuple[float, float], str], ...]:
    clearance_m = clearance_field(grid)
    travel_m = travel_field(clearance_m, (20, 15), 0.2, grid.resolution_m)
    return what_remains(grid, clearance_m, travel_m, 0.2)


def test_what_lies_behind_a_narrow_gap_is_named_with_what_is_missing() -> None:
    ((place, why),) = remains(two_rooms(7))
    assert why == "too narrow by 3 cm: passage clearance 0.17 m, needs 0.20 m"
    assert place[0] == pytest.approx(2.7, abs=0.6)


def test_floor_that_no_floor_leads_to_is_named_so() -> None:
    ((_, why),) = remains(two_rooms(0))
    assert why.startswith("no known floor leads there")


def test_a_frontier_that_the_robot_can_come_to_is_no_remainder() -> None:
    assert remains(two_rooms(14)) == ()


def test_places_with_one_reason_share_a_sentence() -> None:
    found = sentences([((1.0, 2.0), "glass"), ((3.0, 4.0), "glass"), ((5.0, 6.0), "dark")])
    assert found == ("(1.0, 2.0) and 1 more: glass", "(5.0, 6.0): dark")

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import ArgumentError, scan_of_grid
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid, Pose2


def room() -> OccupancyGrid:
    cells = np.full((50, 70), FREE, dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    return OccupancyGrid(cells, 0.1, (-1.0, 2.0))


@settings(deadline=None)  # compiles
@given(st.floats(-0.8, 5.8), st.floats(2.2, 6.8), st.floats(-3.1, 3.1))
def test_in_a_box_every_beam_has_the_length_to_the_wall_it_meets(x: float, y: float, yaw: float) -> None:
    scan = scan_of_grid(room(), Pose2(x, y, yaw), 20.0, beams=90)
    heading = scan.angles_rad + yaw
    wall_x = np.where(np.cos(heading) > 0.0, 5.9, -0.9)
    wall_y = np.where(np.sin(heading) > 0.0, 6.9, 2.1)
    with np.errstate(divide="ignore", over="ignore"):
        across, up = (wall_x - x) / np.cos(heading), (wall_y - y) / np.sin(heading)
    expected = np.minimum(np.abs(across), np.abs(up))
    assert np.allclose(scan.ranges_m, np.maximum(expected, 0.01), atol=1e-3)


def test_nothing_within_range_is_no_return_and_beyond_the_map_is_one() -> None:
    scan = scan_of_grid(room(), Pose2(2.5, 4.5, 0.0), 1.0)
    assert np.isinf(scan.ranges_m).all()
    outside = scan_of_grid(room(), Pose2(-5.0, 4.5, 0.0), 5.0)
    assert (outside.ranges_m <= 0.01 + 1e-6).all()


def test_a_range_of_zero_is_refused() -> None:
    with pytest.raises(ArgumentError, match="range_m"):
        scan_of_grid(room(), Pose2.identity(), 0.0)

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.runtime.clearance_window import ClearanceWindow
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

RESOLUTION = 0.05
REACH = 1.0
HERE = Pose2(1.5, 1.5, 0.0)


def distance_to_cells(cells: np.ndarray, at: tuple[float, float]) -> float:
    """From the centre of the cell around ``at`` to the nearest centre of a marked cell, less half a cell."""
    rows, cols = np.nonzero(cells)
    if rows.size == 0:
        return np.inf
    row, col = int(at[1] / RESOLUTION), int(at[0] / RESOLUTION)
    if cells[row, col]:
        return 0.0
    return (float(np.hypot(rows - row, cols - col).min()) - 0.5) * RESOLUTION


@given(
    st.lists(st.tuples(st.integers(20, 39), st.integers(20, 39)), max_size=8),
    st.lists(st.tuples(st.integers(20, 39), st.integers(20, 39)), max_size=8),
    st.lists(st.integers(0, 7), max_size=4),
    st.tuples(*[st.integers(22, 37)] * 2, *[st.floats(0.01, 0.99)] * 2).map(
        lambda drawn: ((drawn[0] + drawn[2]) * RESOLUTION, (drawn[1] + drawn[3]) * RESOLUTION)
    ),  # not on a line between cells, which belongs to either
)
@settings(deadline=None)
def test_unknown_counts_and_obstacles_count_unless_the_scan_shows_them(
    occupied: list[tuple[int, int]],
    unknown: list[tuple[int, int]],
    shown: list[int],
    at: tuple[float, float],
) -> None:
    cells = np.full((60, 60), FREE, dtype=np.int8)
    for row, col in unknown:
        cells[row, col] = UNKNOWN
    for row, col in occupied:
        cells[row, col] = OCCUPIED
    seen = [occupied[i] for i in shown if i < len(occupied)]
    points = np.array([((col + 0.5) * RESOLUTION, (row + 0.5) * RESOLUTION) for row, col in seen])
    counts = cells != FREE
    for row, col in seen:  # a point stands for its cell and the eight around it
        around = (slice(row - 1, row + 2), slice(col - 1, col + 2))
        counts[around] &= cells[around] != OCCUPIED
    window = ClearanceWindow(REACH)
    window.cut(OccupancyGrid(cells, RESOLUTION, (0.0, 0.0)), HERE, points.reshape(-1, 2))
    expected = min(distance_to_cells(counts, at), 0.5)
    assert min(window.clearance_m(np.array([at]))[0], 0.5) == pytest.approx(expected, abs=1e-5)


def test_beyond_the_window_and_beyond_the_map_nothing_is_free() -> None:
    window = ClearanceWindow(REACH)
    floor = OccupancyGrid(np.full((60, 60), FREE, dtype=np.int8), RESOLUTION, (0.0, 0.0))
    window.cut(floor, HERE, np.zeros((0, 2)))
    assert window.clearance_m(np.array([[1.5, 2.8], [1.5, 1.5]])) == pytest.approx([0.0, 1.0], abs=0.06)
    window.cut(floor, Pose2(90.0, 90.0, 0.0), np.zeros((0, 2)))
    assert window.clearance_m(np.array([[90.0, 90.0]])) == pytest.approx([0.0])

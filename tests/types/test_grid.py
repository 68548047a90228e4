import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.types import FREE, UNKNOWN, GridWindow, OccupancyGrid


def grid_of(rows: int, cols: int, resolution: float, origin: tuple[float, float]) -> OccupancyGrid:
    return OccupancyGrid(np.zeros((rows, cols), dtype=np.int8), resolution, origin)


@given(st.integers(1, 50), st.integers(1, 50), st.floats(0.01, 1.0), st.floats(-50, 50), st.floats(-50, 50))
def test_the_centre_of_a_cell_lies_in_that_cell(
    rows: int, cols: int, resolution: float, x: float, y: float
) -> None:
    grid = grid_of(rows, cols, resolution, (x, y))
    assert grid.cell_of(*grid.center_of(rows - 1, cols - 1)) == (rows - 1, cols - 1)
    cells = np.array([[0, 0], [rows - 1, cols - 1]])
    np.testing.assert_array_equal(grid.cells_of(grid.centers_of(cells)), cells)


def test_outside_the_grid_is_unknown() -> None:
    grid = grid_of(2, 3, 0.5, (0.0, 0.0))
    assert grid.value_at(1.4, 0.9) == FREE
    assert grid.value_at(1.6, 0.9) == UNKNOWN
    assert grid.value_at(-0.01, 0.5) == UNKNOWN


def test_a_grid_cannot_be_written_to() -> None:
    with pytest.raises(ValueError, match="read-only"):
        grid_of(2, 2, 0.5, (0.0, 0.0)).cells[0, 0] = 1


def marked(window: GridWindow, shape: tuple[int, int] = (20, 20)) -> np.ndarray:
    cells = np.zeros(shape, dtype=np.uint8)
    cells[window.slices] = 1
    return cells


windows = st.tuples(*[st.integers(0, 16)] * 2, *[st.integers(1, 4)] * 2).map(
    lambda at: GridWindow(at[0], at[1], at[0] + at[2], at[1] + at[3])
)


@given(windows, st.integers(0, 5))
def test_a_grown_window_holds_every_cell_that_near_and_stays_in_the_grid(window: GridWindow, by: int) -> None:
    near = np.array(
        [
            [window.row0 - by <= row < window.row1 + by and window.col0 - by <= col < window.col1 + by]
            for row in range(20)
            for col in range(20)
        ]
    ).reshape(20, 20)
    np.testing.assert_array_equal(marked(window.grown(by, (20, 20))), near)


@given(windows, windows)
def test_joined_windows_hold_both_and_no_row_or_column_more(one: GridWindow, other: GridWindow) -> None:
    both = marked(one) | marked(other)
    joined = marked(one.joined(other))
    assert (joined >= both).all()
    for axis in (0, 1):
        edges = np.flatnonzero(both.any(axis=axis))
        assert np.flatnonzero(joined.any(axis=axis)).tolist() == list(range(edges[0], edges[-1] + 1))


@given(windows)
def test_joined_with_nothing_a_window_stays_as_it_is(window: GridWindow) -> None:
    nothing = GridWindow(0, 0, 0, 0)
    assert window.joined(nothing) == nothing.joined(window) == window


@given(windows, st.integers(0, 5), st.integers(0, 5))
def test_a_moved_window_marks_the_cells_moved(window: GridWindow, rows: int, cols: int) -> None:
    expected = np.zeros((30, 30), dtype=np.uint8)
    expected[rows : rows + 20, cols : cols + 20] = marked(window)
    np.testing.assert_array_equal(marked(window.moved(rows, cols), (30, 30)), expected)


@given(
    st.integers(1, 30),
    st.integers(1, 30),
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.floats(0.01, 2.0),
)
def test_the_window_around_a_point_holds_every_cell_whose_centre_is_that_near(
    rows: int, cols: int, x: float, y: float, reach_m: float
) -> None:
    grid = OccupancyGrid(np.zeros((rows, cols), dtype=np.int8), 0.05, (-0.7, 0.3))
    window = grid.window_around(x, y, reach_m)
    inside = np.zeros(grid.shape, dtype=bool)
    inside[window.slices] = True
    cells = np.argwhere(np.ones(grid.shape, dtype=bool))
    off_m = np.abs(grid.centers_of(cells) - (x, y)).max(axis=1).reshape(grid.shape)
    assert inside[off_m <= reach_m].all()
    assert not inside[off_m > reach_m + 1.5 * grid.resolution_m].any()
    assert 0 <= window.row0 <= window.row1 <= rows
    assert 0 <= window.col0 <= window.col1 <= cols

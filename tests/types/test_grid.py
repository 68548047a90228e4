import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.types import FREE, UNKNOWN, OccupancyGrid


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

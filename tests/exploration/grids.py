"""Small maps drawn in text, and hypothesis strategies for random ones."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

VALUES = {".": FREE, "#": OCCUPIED, "?": UNKNOWN}


def drawn(text: str, resolution_m: float = 0.1, origin_xy: tuple[float, float] = (0.0, 0.0)) -> OccupancyGrid:
    """The first line is row 0, the lowest y."""
    rows = [[VALUES[mark] for mark in line.strip()] for line in text.strip().splitlines()]
    return OccupancyGrid(np.array(rows, dtype=np.int8), resolution_m, origin_xy)


def random_cells(most: int = 14, weights: str = "...#?") -> st.SearchStrategy[np.ndarray]:
    return hnp.arrays(
        np.int8,
        st.tuples(st.integers(1, most), st.integers(1, most)),
        elements=st.sampled_from([VALUES[mark] for mark in weights]),
    )

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import Outlooks
from explore_bt.types import FREE, OCCUPIED, UNKNOWN
from tests.exploration.grids import random_cells


def seen_slowly(cells: np.ndarray, row: int, col: int, reach: float, depth: float) -> set[int]:
    """All crossings of a ray with the lines between cells, sorted; the cell at the middle of each piece."""
    found = set()
    rays = int(0.6 * 2.0 * math.pi * reach)
    for k in range(rays):
        du, dv = math.cos(2.0 * math.pi * k / rays), math.sin(2.0 * math.pi * k / rays)
        lines = np.arange(0.5, reach + 1.0)
        cuts = np.concatenate([lines / abs(d) for d in (du, dv) if d != 0.0])
        cuts = np.concatenate(([0.0], np.sort(cuts[cuts < 3.0 * reach])))
        passed = 0.0
        for entry, leave in pairwise(cuts):
            if entry > reach:
                break
            if leave - entry < 1e-9:
                continue
            middle = 0.5 * (entry + leave)
            r, c = math.floor(row + 0.5 + middle * dv), math.floor(col + 0.5 + middle * du)
            if not (0 <= r < cells.shape[0] and 0 <= c < cells.shape[1]) or cells[r, c] == OCCUPIED:
                break
            if cells[r, c] == UNKNOWN:
                if passed >= depth - 1e-9:
                    break
                passed += leave - entry
                found.add(r * cells.shape[1] + c)
    return found


def places_of(cells: np.ndarray) -> np.ndarray:
    return np.argwhere(cells == FREE)


def as_sets(outlooks: Outlooks, cells: np.ndarray, places: np.ndarray) -> list[set[int]]:
    view = outlooks.look(cells, places, 4.3, 1.7)
    return [set(view.cells[a:b].tolist()) for a, b in pairwise(view.begin)]


@settings(max_examples=40, deadline=None)
@given(random_cells(10))
def test_places_see_what_a_slow_walk_along_each_ray_sees(cells: np.ndarray) -> None:
    places = places_of(cells)[:5]
    for place, found in zip(places, as_sets(Outlooks(), cells, places), strict=True):
        slow = seen_slowly(cells, int(place[0]), int(place[1]), 4.3, 1.7)
        assert len(found ^ slow) <= 0.1 * len(slow) + 2  # rays through a corner may take either side


@settings(max_examples=60, deadline=None)
@given(random_cells(12), st.data())
def test_looking_again_after_changes_is_as_looking_for_the_first_time(cells: np.ndarray, data) -> None:
    outlooks = Outlooks()
    for _ in range(3):
        places = places_of(cells)
        assert as_sets(outlooks, cells, places) == as_sets(Outlooks(), cells, places)
        cells = cells.copy()
        row, col = data.draw(st.integers(0, 11)), data.draw(st.integers(0, 11))
        cells[row : row + 3, col : col + 3] = data.draw(st.sampled_from([FREE, OCCUPIED, UNKNOWN]))

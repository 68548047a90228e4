import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.exploration import ArgumentError, way_back

SPACING = 0.05


@st.composite
def drives(draw: st.DrawFn) -> NDArray[np.float64]:
    """Ways with bends, halts and crossings, 1 to 12 cm from one place to the next."""
    steps = draw(
        st.lists(st.tuples(st.floats(0.0, 0.12), st.floats(-math.pi, math.pi)), min_size=0, max_size=60)
    )
    places = [(0.0, 0.0)]
    for length, heading in steps:
        x, y = places[-1]
        places.append((x + length * math.cos(heading), y + length * math.sin(heading)))
    return np.array(places)


@given(drives())
def test_it_begins_here_and_keeps_to_places_that_were_driven_through(driven: NDArray[np.float64]) -> None:
    way = way_back(driven, 10.0)
    assert np.array_equal(way[0], driven[-1])
    order = [int(np.flatnonzero((driven == place).all(axis=1))[-1]) for place in way]
    assert order == sorted(order, reverse=True)


@given(drives())
def test_it_never_comes_back_to_where_it_was(driven: NDArray[np.float64]) -> None:
    way = way_back(driven, 10.0)
    for i, place in enumerate(way):
        for earlier in way[:i]:
            assert math.dist(place, earlier) >= SPACING


def test_a_detour_is_left_out() -> None:
    into = np.column_stack((np.arange(0.0, 1.0, 0.06), np.zeros(17)))
    detour = np.array([[0.96, 0.06 * i] for i in (1, 2, 3, 3, 2, 1, 0)])
    way = way_back(np.vstack((into, detour)), 10.0)
    assert np.allclose(way[:, 1], 0.0)
    assert way[-1, 0] == pytest.approx(0.0)


def test_it_is_no_longer_than_asked_for() -> None:
    driven = np.column_stack((np.arange(0.0, 9.0, 0.05001), np.zeros(180)))
    assert len(way_back(driven, 1.0)) == pytest.approx(1.0 / SPACING, abs=1)


def test_a_length_of_nothing_is_refused() -> None:
    with pytest.raises(ArgumentError, match=r"length_m: 0\.0 found"):
        way_back(np.zeros((1, 2)), 0.0)

from __future__ import annotations

import itertools
import math

import numpy as np
from explore_bt_drivers.people.strides import ACCELERATION_MPS2, TURN_MPS, as_people_walk
from hypothesis import given
from hypothesis import strategies as st

coordinates = st.integers(-50, 50).map(lambda tenths: 0.1 * tenths)
ways = st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=12).filter(
    lambda points: len(set(points)) > 2
)


def walked(points, speed: float) -> np.ndarray:
    """(N, 3) the knots up to the last corner but one."""
    return np.array(list(as_people_walk(points, speed)))


@given(ways, st.floats(0.3, 2.0))
def test_nobody_is_faster_than_their_speed_nor_jumps_from_one_velocity_to_another(points, speed) -> None:
    knots = walked(points, speed)
    spans = np.diff(knots[:, 0])
    assert (spans > 0.0).all()
    velocities = np.diff(knots[:, 1:], axis=0) / spans[:, None]
    assert np.hypot(*velocities.T).max() <= speed + 1e-6
    changes = np.hypot(*np.diff(velocities, axis=0).T)
    within_s = 0.5 * (spans[1:] + spans[:-1])
    assert (changes <= TURN_MPS + ACCELERATION_MPS2 * within_s + 1e-6).all()


@given(ways, st.floats(0.3, 2.0))
def test_every_corner_is_come_to_in_its_order(points, speed) -> None:
    knots = walked(points, speed)
    corners = [point for point, _ in itertools.groupby(points)]
    at = 0
    for x, y in corners[:-1]:
        away = np.hypot(knots[at:, 1] - x, knots[at:, 2] - y)
        assert away.min() < 1e-9
        at += int((away < 1e-9).argmax())


def test_a_long_straight_way_is_walked_at_full_speed() -> None:
    knots = walked([(0.0, 0.0), (12.0, 0.0), (0.0, 0.0)], 1.2)
    assert math.isclose(knots[-1, 0], 12.0 / 1.2, rel_tol=0.1)

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import UserError
from explore_bt.exploration import HalfPlane, HalfPlaneHistory
from explore_bt.types import Pose2

coordinate = st.floats(-50, 50)
angle = st.floats(-7, 7)
planes = st.lists(st.builds(HalfPlane, st.tuples(coordinate, coordinate), angle), max_size=8)


def lies_ahead(plane: HalfPlane, xy: tuple[float, float]) -> bool | None:
    """By the bearing of the point instead of a scalar product; None on the line."""
    dx, dy = xy[0] - plane.position[0], xy[1] - plane.position[1]
    if math.hypot(dx, dy) < 1e-6:
        return None
    off = abs(math.remainder(math.atan2(dy, dx) - plane.heading_rad, 2 * math.pi))
    return None if abs(off - math.pi / 2) < 1e-6 else off < math.pi / 2


@settings(deadline=None)
@given(planes, st.tuples(coordinate, coordinate), st.sampled_from([1, 3, None]))
def test_a_history_holds_what_every_half_plane_of_its_window_holds(stack, xy, window):
    history = HalfPlaneHistory()
    for plane in stack:
        history = history.push(plane)
    wanted = stack if window is None else stack[max(0, len(stack) - window) :]
    answers = [lies_ahead(plane, xy) for plane in wanted]
    if None not in answers:
        assert history.contains(xy, window) is all(answers)


@settings(deadline=None)
@given(planes, st.tuples(coordinate, coordinate))
def test_a_reset_history_constrains_nothing_and_leaves_the_old_one_alone(stack, xy):
    history = HalfPlaneHistory(tuple(stack))
    assert history.reset().contains(xy)
    assert history.planes == tuple(stack)


def test_a_point_abreast_of_the_robot_is_in_its_half_plane():
    plane = HalfPlane.ahead_of(Pose2(3.0, 4.0, 0.3))
    assert plane.contains((3.0 - 2.0 * math.sin(0.3), 4.0 + 2.0 * math.cos(0.3)))
    assert plane.contains((3.0, 4.0))


def test_headings_beyond_a_quarter_turn_keep_the_forward_side():
    # tan(90° + r) as printed in the paper flips side here
    assert HalfPlane((0.0, 0.0), math.pi).contains((-1.0, 0.0))
    assert not HalfPlane((0.0, 0.0), math.pi).contains((1.0, 0.0))


def test_with_one_half_plane_only_the_newest_counts():
    history = HalfPlaneHistory().push(HalfPlane((0.0, 0.0), 0.0)).push(HalfPlane((5.0, 0.0), math.pi))
    assert history.contains((-1.0, 0.0), window=1)
    assert not history.contains((-1.0, 0.0))


def test_a_window_below_one_is_refused():
    with pytest.raises(UserError, match=r"half_planes: 0 found, expected a finite number of at least 1"):
        HalfPlaneHistory().last(0)

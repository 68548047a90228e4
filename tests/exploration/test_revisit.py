import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import is_allowed, repeated_visit
from explore_bt.types import Pose2

pose = st.builds(Pose2, st.floats(-8, 8), st.floats(-8, 8), st.floats(-math.pi, math.pi))


def allowed_by_the_pseudo_code(candidate, visited, detection_range_m, revisit_cosine):
    """The two branches as printed, with unit vectors; None within a hair of either bound."""
    verdict = True
    for p in visited:
        far = np.linalg.norm(np.subtract(candidate.xy, p.xy))
        r1 = np.array([math.cos(candidate.yaw_rad), math.sin(candidate.yaw_rad)])
        r2 = np.array([math.cos(p.yaw_rad), math.sin(p.yaw_rad)])
        if abs(far - detection_range_m) < 1e-5 or abs(r1 @ r2 - revisit_cosine) < 1e-9:
            return None
        if far < detection_range_m and not r1 @ r2 <= revisit_cosine:
            verdict = False
    return verdict


@settings(deadline=None)
@given(pose, st.lists(pose, max_size=6), st.floats(0.2, 9), st.sampled_from([-0.9, 0.0, 0.5, 0.99, 1.0]))
def test_a_heading_is_allowed_as_the_pseudo_code_says(candidate, visited, l_m, cosine):
    expected = allowed_by_the_pseudo_code(candidate, visited, l_m, cosine)
    if expected is not None:
        assert is_allowed(candidate, visited, l_m, cosine) is expected


@settings(deadline=None)
@given(pose, st.lists(pose, max_size=6), st.floats(0.2, 9))
def test_at_one_the_rule_is_off(candidate, visited, l_m):
    assert is_allowed(candidate, [*visited, candidate], l_m, 1.0)


def test_the_opposite_direction_through_the_same_place_is_allowed():
    there, back = Pose2(1.0, 1.0, 0.4), Pose2(1.1, 1.0, 0.4 - math.pi)
    assert is_allowed(back, [there], 2.0, 0.5)
    assert not is_allowed(Pose2(1.1, 1.0, 0.4), [there], 2.0, 0.5)


def test_the_nearest_of_the_forbidding_visits_is_named():
    near, far, other_way = Pose2(0.5, 0.0, 0.0), Pose2(1.0, 0.0, 0.0), Pose2(0.1, 0.0, math.pi)
    assert repeated_visit(Pose2(0.0, 0.0, 0.0), [far, near, other_way], 2.0, 0.5) is near


def test_a_visit_at_the_detection_range_exactly_does_not_forbid_going_straight_on():
    start, step = Pose2(0.1, 0.2, 0.3), 2.0
    ahead = Pose2(0.1 + step * math.cos(0.3), 0.2 + step * math.sin(0.3), 0.3)
    assert is_allowed(ahead, [start], step, 0.5)

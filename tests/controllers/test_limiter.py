import numpy as np
import pytest
from explore_bt_controllers.limiter import approach, next_velocity
from explore_bt_controllers.look_ahead import fastest_velocity
from hypothesis import given, settings
from hypothesis import strategies as st

PERIODS = st.lists(st.floats(0.02, 0.1), min_size=20, max_size=120)
TARGETS = st.lists(st.floats(-2.0, 2.0), min_size=20, max_size=120)
SMALL = 1e-9


@settings(deadline=None, max_examples=150)
@given(PERIODS, TARGETS, st.floats(0.2, 1.5), st.floats(0.2, 3.0), st.floats(0.5, 10.0))
def test_no_sequence_of_targets_and_periods_breaks_a_limit(periods, targets, highest, acceleration, jerk):
    v = a = 0.0
    for dt, target in zip(periods, targets, strict=False):
        after = next_velocity(v, a, target, 0.0, dt, -highest, highest, acceleration, jerk)
        gain = (after - v) / dt
        assert abs(after) <= highest + SMALL
        assert abs(gain) <= acceleration + 1e-7
        assert abs(gain - a) <= jerk * dt + 1e-6
        v, a = after, gain


@settings(deadline=None, max_examples=100)
@given(PERIODS, st.floats(-1.0, 1.0), st.floats(0.5, 10.0))
def test_a_steady_target_is_reached_without_passing_it(periods, target, jerk):
    v = a = 0.0
    for dt in periods:
        after = next_velocity(v, a, target, 0.0, dt, -1.0, 1.0, 1.0, jerk)
        a, v = (after - v) / dt, after
        assert abs(v) <= abs(target) + SMALL
    for _ in range(400):
        after = next_velocity(v, a, target, 0.0, 0.05, -1.0, 1.0, 1.0, jerk)
        a, v = (after - v) / 0.05, after
    assert v == target


def test_both_directions_are_served_alike():
    rng = np.random.default_rng(0)
    for v, a, target, dt in rng.uniform([-1, -1, -1, 0.02], [1, 1, 1, 0.1], size=(200, 4)):
        one = next_velocity(v, a, target, 0.0, dt, -1.0, 1.0, 1.0, 4.0)
        other = next_velocity(-v, -a, -target, 0.0, dt, -1.0, 1.0, 1.0, 4.0)
        assert one == -other


def test_a_smooth_target_is_tracked_without_lag():
    dt, v, a = 0.05, 0.0, 0.0
    errors = []
    for k in range(1, 200):
        time = k * dt
        target, rate = 0.5 * np.sin(time), 0.5 * np.cos(time)
        after = next_velocity(v, a, target, rate, dt, -1.0, 1.0, 2.0, 8.0)
        a, v = (after - v) / dt, after
        errors.append(abs(v - target))
    assert max(errors[40:]) < 0.005


def test_a_cut_limit_is_approached_as_fast_as_acceleration_and_jerk_allow():
    v, a, seen = 1.0, 0.3, []
    for _ in range(60):
        after = next_velocity(v, a, 1.0, 0.0, 0.05, -0.4, 0.4, 0.5, 2.0)
        gain = (after - v) / 0.05
        assert abs(gain - a) <= 2.0 * 0.05 + 1e-9
        a, v = gain, after
        seen.append(v)
    assert seen[-1] <= 0.4 + 1e-6
    assert min(seen) >= 0.4 - 1e-6
    assert seen[40] < 0.45


def test_an_acceleration_above_its_limit_is_led_back_under_it():
    v, a = 0.2, 2.0
    for _ in range(20):
        after = next_velocity(v, a, 0.5, 0.0, 0.05, -0.5, 0.5, 0.5, 2.0)
        gain = (after - v) / 0.05
        assert abs(gain) <= max(0.5, a - 0.1) + 1e-7
        a, v = gain, after


def test_the_approach_solves_its_equation():
    for gap in (0.001, 0.1, 2.0):
        a = approach(gap, 0.05, 4.0)
        assert np.isclose(a * 0.05 + a * a / 8.0, gap)
        assert approach(-gap, 0.05, 4.0) == -a


@pytest.mark.parametrize("seed", range(30))
def test_speed_is_down_wherever_the_path_asks_for_it_and_ends_at_the_end(seed):
    rng = np.random.default_rng(seed)
    slow = rng.uniform(0.05, 0.6, rng.integers(3, 30))
    periods = rng.uniform(0.02, 0.1, 400)
    limits = np.repeat(slow, 10)
    spacing = 0.02
    length = spacing * len(limits)
    v = a = s = 0.0
    for dt in periods:
        after = fastest_velocity(v, a, 1.0, s, limits, spacing, length, dt, 0.5, 0.5, 2.0)
        gain = (after - v) / dt
        assert -1e-9 <= after <= 0.5 + SMALL
        assert abs(gain) <= 0.5 + 1e-7
        assert abs(gain - a) <= 2.0 * dt + 1e-6
        s += 0.5 * (v + after) * dt
        v, a = after, gain
        if s < length:
            assert v <= limits[int(s / spacing)] + 0.015
    assert s <= length + 0.002


def test_the_end_is_met_to_the_millimetre():
    limits = np.full(100, 0.5)
    v = a = s = 0.0
    for _ in range(400):
        after = fastest_velocity(v, a, 1.0, s, limits, 0.02, 2.0, 0.05, 0.5, 0.5, 2.0)
        s += 0.5 * (v + after) * 0.05
        a, v = (after - v) / 0.05, after
    assert abs(s - 2.0) < 0.002
    assert v < 1e-3

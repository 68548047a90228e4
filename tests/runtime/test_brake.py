import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.runtime.brake import brake_duration_s, brake_velocity

limits = st.tuples(st.floats(0.2, 3.0), st.floats(0.5, 10.0))


def integrated(v: float, a: float, a_max: float, j_max: float) -> tuple[np.ndarray, np.ndarray]:
    times = np.linspace(0.0, brake_duration_s(v, a, a_max, j_max) + 0.1, 4001)
    return times, brake_velocity(v, a, a_max, j_max, times)


@given(st.floats(-2.0, 2.0), st.floats(-1.0, 1.0), limits)
@settings(deadline=None)
def test_a_brake_keeps_acceleration_and_jerk_limits_and_ends_at_rest(
    v: float, share: float, limit: tuple[float, float]
) -> None:
    a_max, j_max = limit
    times, velocity = integrated(v, share * a_max, a_max, j_max)
    step = times[1]
    acceleration = np.diff(velocity) / step
    assert np.abs(acceleration).max() <= a_max * (1 + 1e-6) + 1e-9
    assert np.abs(np.diff(acceleration)).max() <= j_max * step * (1 + 1e-3) + 1e-6
    assert velocity[-1] == 0.0
    assert abs(velocity[times <= times[-1] - 0.1][-1]) < 1e-2


@given(st.floats(-2.0, 2.0), st.floats(-1.0, 1.0), limits)
@settings(deadline=None, max_examples=25)
def test_no_bang_bang_brake_found_by_search_is_faster(
    v: float, share: float, limit: tuple[float, float]
) -> None:
    a_max, j_max = limit
    a = share * a_max
    ours = brake_duration_s(v, a, a_max, j_max)
    assert ours <= _fastest_by_search(v, a, a_max, j_max) * 1.02 + 0.01


def _fastest_by_search(v: float, a: float, a_max: float, j_max: float) -> float:
    """Every three-phase profile on a fine lattice of peak accelerations."""
    best = np.inf
    for peak in np.linspace(-a_max, a_max, 801):
        t1 = abs(peak - a) / j_max
        t3 = abs(peak) / j_max
        rest = v + 0.5 * (a + peak) * t1 + 0.5 * peak * t3
        if abs(peak) > 1e-9 and rest / -peak >= 0.0:
            best = min(best, t1 + t3 + rest / -peak)
    return best


def test_braking_from_half_a_metre_per_second_while_speeding_up_takes_half_a_metre() -> None:
    times, velocity = integrated(0.5, 0.5, 0.5, 2.0)
    assert abs(np.trapezoid(velocity, times) - 0.52) < 0.03

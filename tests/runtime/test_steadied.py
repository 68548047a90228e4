import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.runtime.steadied import steadied
from explore_bt.testing.fake_robot import full_circle_scan


def slowly(ranges: np.ndarray, step: float) -> np.ndarray:
    """The same by plain Python."""
    out = ranges.copy()
    for i, distance in enumerate(ranges):
        half = int(0.01 / (step * distance)) if np.isfinite(distance) and 0.05 <= distance <= 5.0 else 0
        near = [r for r in ranges[max(0, i - half) : i + half + 1] if np.isfinite(r) and 0.05 <= r <= 5.0]
        if half:
            out[i] = np.median(near)
    return out


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=30)
def test_medians_are_those_of_the_slow_version(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ranges = rng.uniform(0.1, 1.0, 360).astype(np.float32)
    ranges[rng.random(360) < 0.05] = np.nan
    ranges[rng.random(360) < 0.05] = np.inf
    np.testing.assert_array_equal(steadied(full_circle_scan(ranges)).ranges_m, slowly(ranges, np.pi / 180.0))


def test_noise_close_by_shrinks_and_the_least_range_with_it() -> None:
    rng = np.random.default_rng(0)
    scan = full_circle_scan((0.3 + rng.normal(0.0, 0.01, 360)).astype(np.float32))
    calm = steadied(scan)
    assert calm.ranges_m.std() < 0.65 * scan.ranges_m.std()
    assert calm.ranges_m.min() > scan.ranges_m.min() + 0.01


def test_a_post_of_two_centimetres_is_never_lost() -> None:
    for distance in (0.27, 0.35, 0.5, 0.8):
        ranges = np.full(360, 2.0, dtype=np.float32)
        beams = np.abs(np.arange(360) - 180) * np.pi / 180.0 * distance <= 0.01
        ranges[beams] = distance
        assert steadied(full_circle_scan(ranges)).ranges_m.min() == np.float32(distance)

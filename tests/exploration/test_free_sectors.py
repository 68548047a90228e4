import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from explore_bt.errors import UserError
from explore_bt.exploration import FreeSector, find_free_sectors, order_by_safety
from explore_bt.types import Pose2, Scan2D

TURN = 2 * math.pi
RANGE_M = 6.0


def scan_of(ranges, *, fov=TURN, at=Pose2(0.0, 0.0, 0.0)):
    ranges = np.asarray(ranges, dtype=np.float32)
    angles = np.linspace(-fov / 2, fov / 2, len(ranges), endpoint=fov < TURN)
    return Scan2D(0.0, angles, ranges, np.zeros(len(ranges)), 0.05, RANGE_M, T_base_sensor=at)


def between(a: float, b: float) -> float:
    return abs(math.remainder(a - b, TURN))


def is_free(direction, scan, detection_range_m, radius_m, facing_rad):
    """Direct reading of step 1 for one direction; None within a hair of a bound."""
    half_step = (scan.angles_rad[1] - scan.angles_rad[0]) / 2
    verdicts = [between(direction, facing_rad) - math.pi / 2]
    bearings = scan.angles_rad + scan.T_base_sensor.yaw_rad
    verdicts.append(min(between(direction, b) for b in bearings) - half_step)  # nobody looks there
    for bearing, reach in zip(bearings, scan.ranges_m.astype(float), strict=True):
        if math.isnan(reach) or reach < scan.range_min_m:
            verdicts.append(half_step - between(direction, bearing))
        elif reach < detection_range_m and reach <= scan.range_max_m:
            off = between(direction, bearing)
            verdicts.append(half_step - off)
            if reach <= radius_m:
                verdicts.append(math.pi / 2 - off)
            elif off < math.pi / 2:  # distance from the obstacle to the line of travel
                verdicts.append(radius_m - reach * math.sin(off))
    if any(abs(v) < 1e-6 for v in verdicts):
        return None
    return all(v < 0 for v in verdicts)


reading = st.one_of(
    st.just(math.inf), st.just(math.nan), st.floats(0.125, 5.875, width=32), st.floats(3.0, 5.875, width=32)
)


@settings(deadline=None, max_examples=150)
@given(
    st.lists(reading, min_size=37, max_size=90),
    st.floats(0.3, 5.0),
    st.floats(0.0, 0.5),
    st.floats(0.0, 0.1),
    st.sampled_from([TURN, math.pi, 1.5 * math.pi]),
    st.sampled_from([0.0, math.pi, -2.0]),
    st.floats(-3.0, 3.0),
)
def test_sectors_are_what_dense_sampling_finds(ranges, l_m, radius_m, margin_m, fov, facing, yaw):
    assume(not any(abs(reach - l_m) < 1e-5 for reach in ranges))
    scan = scan_of(ranges, fov=fov, at=Pose2(0.0, 0.0, yaw))
    sectors = find_free_sectors(
        scan, detection_range_m=l_m, footprint_radius_m=radius_m, margin_m=margin_m, facing_rad=facing
    )
    for direction in facing + np.linspace(-1.7, 1.7, 301):
        expected = is_free(direction, scan, l_m, radius_m + margin_m, facing)
        if expected is not None:
            assert any(s.contains(direction) for s in sectors) == expected, direction


@settings(deadline=None, max_examples=60)
@given(st.lists(reading, min_size=40, max_size=80), st.floats(0.5, 5.0))
def test_sectors_are_disjoint_and_maximal(ranges, l_m):
    sectors = find_free_sectors(scan_of(ranges), detection_range_m=l_m, footprint_radius_m=0.25)
    ordered = sorted(sectors, key=lambda s: s.start_rad)
    for left, right in itertools.pairwise(ordered):
        assert left.end_rad < right.start_rad
    assert all(0 < s.width_rad <= math.pi for s in sectors)


@pytest.mark.parametrize("facing", [0.0, math.pi, 0.7])
def test_without_obstacles_the_sector_is_the_whole_semicircle(facing):
    (sector,) = find_free_sectors(
        scan_of([math.inf] * 360), detection_range_m=5.0, footprint_radius_m=0.25, facing_rad=facing
    )
    assert sector.width_rad == pytest.approx(math.pi)
    assert sector.bisector_rad == pytest.approx(facing)
    assert sector.bisector_clearance_m == RANGE_M


def test_a_return_at_the_detection_range_or_beyond_is_free():
    ranges = np.full(360, 2.0)
    (sector,) = find_free_sectors(scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25)
    assert sector.width_rad == pytest.approx(math.pi)
    assert find_free_sectors(scan_of(ranges), detection_range_m=2.01, footprint_radius_m=0.25) == ()


def test_an_obstacle_within_the_footprint_blocks_a_quarter_turn_either_way():
    ranges = np.full(360, math.inf)
    ranges[180] = 0.2  # straight ahead
    assert find_free_sectors(scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25) == ()
    (behind,) = find_free_sectors(
        scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25, facing_rad=math.pi
    )
    assert behind.width_rad == pytest.approx(math.pi)


def test_a_gate_of_two_posts_is_bisected():
    ranges = np.full(360, math.inf)
    ranges[[180 - 30, 180 + 50]] = 1.0
    widest = find_free_sectors(scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25)[0]
    assert widest.width_rad == pytest.approx(math.radians(80) - 2 * math.asin(0.25))
    assert widest.bisector_rad == pytest.approx(math.radians(10))
    assert widest.bisector_clearance_m == pytest.approx(math.sin(math.radians(40)))


def test_a_drop_out_blocks_its_own_cell_only():
    ranges = np.full(360, math.inf)
    ranges[180] = math.nan
    sectors = find_free_sectors(scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25)
    assert [s.width_rad for s in sectors] == pytest.approx([math.radians(89.5)] * 2)


@pytest.mark.parametrize(("bridge", "count"), [(0, 2), (1, 2), (2, 1), (5, 1)])
def test_a_bridge_spans_drop_outs_up_to_its_length(bridge, count):
    ranges = np.full(360, math.inf)
    ranges[180:182] = math.nan
    sectors = find_free_sectors(
        scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25, bridge_beams=bridge
    )
    assert len(sectors) == count


@pytest.mark.parametrize("at", [0, 90, 180, 359])
def test_a_bridge_works_all_round_the_scan(at):
    ranges = np.full(360, math.inf)
    ranges[[at, (at + 1) % 360]] = math.nan
    facing = math.radians(at - 180)
    (sector,) = find_free_sectors(
        scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25, bridge_beams=2, facing_rad=facing
    )
    assert sector.width_rad == pytest.approx(math.pi)


def test_no_bridge_leans_on_an_obstacle():
    ranges = np.full(360, math.inf)
    ranges[180:182] = math.nan
    ranges[182] = 1.0
    args = {"detection_range_m": 2.0, "footprint_radius_m": 0.0}
    assert find_free_sectors(scan_of(ranges), bridge_beams=5, **args) == find_free_sectors(
        scan_of(ranges), bridge_beams=0, **args
    )


def test_no_bridge_spans_what_the_lidar_does_not_look_at():
    ranges = np.full(181, math.inf)
    ranges[180] = math.nan  # the last beam, at +90°; the next one round the circle is the first
    (sector,) = find_free_sectors(
        scan_of(ranges, fov=math.pi), detection_range_m=2.0, footprint_radius_m=0.25, bridge_beams=3
    )
    assert sector.end_rad == pytest.approx(math.radians(89.5))


def test_a_drop_out_between_uneven_beams_blocks_halfway_to_each_neighbour():
    angles = np.radians([*range(-100, 1), 1.4, *np.arange(2.4, 100)])
    ranges = np.full(angles.size, np.inf, np.float32)
    ranges[101] = np.nan
    scan = Scan2D(0.0, angles, ranges, np.zeros(angles.size), 0.05, RANGE_M)
    sectors = find_free_sectors(scan, detection_range_m=2.0, footprint_radius_m=0.25)
    left, right = sorted(sectors, key=lambda s: s.start_rad)
    assert math.degrees(left.end_rad) == pytest.approx(0.7)
    assert math.degrees(right.start_rad) == pytest.approx(1.9)


def test_a_scan_of_drop_outs_or_of_nothing_has_no_sector():
    for ranges in ([math.nan] * 360, []):
        assert find_free_sectors(scan_of(ranges), detection_range_m=2.0, footprint_radius_m=0.25) == ()


def test_a_lidar_that_looks_ahead_knows_nothing_behind():
    scan = scan_of([math.inf] * 181, fov=math.pi)
    behind = find_free_sectors(scan, detection_range_m=2.0, footprint_radius_m=0.25, facing_rad=math.pi)
    assert sum(s.width_rad for s in behind) <= math.radians(1.0) + 1e-9
    (ahead,) = find_free_sectors(scan, detection_range_m=2.0, footprint_radius_m=0.25)
    assert ahead.bisector_rad == pytest.approx(0.0)


def test_returns_count_from_the_centre_of_the_robot_wherever_the_lidar_sits():
    ranges = np.full(360, math.inf)
    ranges[180] = 1.0
    scan = scan_of(ranges, at=Pose2(0.5, 0.0, 0.0))
    left, _right = find_free_sectors(scan, detection_range_m=2.0, footprint_radius_m=0.3)
    assert left.start_rad == pytest.approx(-math.pi / 2)
    assert left.end_rad == pytest.approx(-math.asin(0.3 / 1.5), abs=1e-6)


sector = st.builds(
    FreeSector,
    st.floats(-1.5, 1.5),
    st.sampled_from([0.2, 0.204, 0.21, 0.5, 1.0]),
    st.sampled_from([0.3, 0.305, 0.6]),
)


@settings(deadline=None)
@given(st.lists(sector, max_size=7), st.randoms())
def test_the_order_of_safety_does_not_hang_on_the_order_of_discovery(sectors, chance):
    shuffled = list(sectors)
    chance.shuffle(shuffled)
    assert order_by_safety(shuffled) == order_by_safety(sectors)


@settings(deadline=None)
@given(st.lists(sector, max_size=7, unique_by=lambda s: s.start_rad))
def test_without_tolerance_the_order_is_width_then_clearance_then_turn(sectors):
    assume(len({abs(s.bisector_rad) for s in sectors}) == len(sectors))
    expected = sorted(sectors, key=lambda s: (-s.width_rad, -s.bisector_clearance_m, abs(s.bisector_rad)))
    assert list(order_by_safety(sectors, width_tolerance_rad=0.0, clearance_tolerance_m=0.0)) == expected


def test_sectors_of_nearly_one_width_go_by_clearance_then_by_the_turn_from_the_facing():
    wide_tight = FreeSector(-0.5, 0.205, 0.3)
    roomy = FreeSector(0.3, 0.2, 0.9)
    near, far = FreeSector(2.9, 0.2, 0.3), FreeSector(-1.6, 0.2, 0.3)
    assert order_by_safety([wide_tight, roomy])[0] is roomy
    assert order_by_safety([far, near], math.pi) == (near, far)


@pytest.mark.parametrize("wrong", [{"detection_range_m": 0.0}, {"footprint_radius_m": -0.1}])
def test_lengths_without_meaning_are_refused_by_name(wrong):
    arguments = {"detection_range_m": 1.0, "footprint_radius_m": 0.2} | wrong
    with pytest.raises(UserError, match=next(iter(wrong))):
        find_free_sectors(scan_of([1.0] * 10), **arguments)

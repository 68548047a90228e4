import bz2
import gzip
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.replay import CarmenLog, ReplayTime
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import LogCutOff, LogError
from explore_bt.types import Measurement, Pose2, Scan2D, WheelOdometry

DATA = os.environ.get("EXPLORE_BT_DATA", "")
FLASER = "FLASER 4 1.5 0 81.91 nan 9 9 9 1 2 0.5 100.25 host 0.1\n"
ROBOTLASER = (
    "ROBOTLASER1 0 -1.5 3 1 30 0.01 0 4 1.0 2.0 30.0 0.0 0 1.1 2 0.5 1 2 0.5 0.2 0.1 0.5 0.5 1e6 101 host 1\n"
)
ODOM = "ODOM 1 2 0.5 0.2 0.1 0 99.5 host 0.05\n"
LOG = "# a comment\nPARAM robot_length 0.4 host 0\n\n" + ODOM + FLASER + ROBOTLASER


def write(folder: Path, text: str | bytes, name: str = "some.clf") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def measured(folder: Path, text: str | bytes, **options: float) -> list[Measurement]:
    return list(CarmenLog(write(folder, text), **options))


def scan_of(folder: Path, text: str, **options: float) -> Scan2D:
    return next(one for one in measured(folder, text, **options) if isinstance(one, Scan2D))


def flaser(*ranges: float, stamp_s: float = 1.0) -> str:
    return f"FLASER {len(ranges)} {' '.join(map(str, ranges))} 0 0 0 0 0 0 {stamp_s} host 0\n"


def test_a_laser_line_is_odometry_then_a_scan_with_its_stamp(tmp_path):
    odometry, scan = measured(tmp_path, FLASER)
    assert (odometry.stamp_s, odometry.T_odom_base) == (100.25, Pose2(1.0, 2.0, 0.5))
    assert scan.stamp_s == 100.25
    np.testing.assert_array_equal(scan.ranges_m, np.array([1.5, np.nan, np.inf, np.nan], dtype=np.float32))
    assert (scan.T_base_sensor, scan.frame) == (Pose2.identity(), "laser")


def two_poses(number: int, laser: Pose2, robot: Pose2) -> str:
    poses = " ".join(f"{value:.6f}" for pose in (laser, robot) for value in pose.as_array())
    return f"FLASER 2 1.0 2.0 {poses} {number} host 0\n"


def test_a_first_pose_that_stays_where_it_is_on_the_robot_places_the_laser(tmp_path):
    mount = Pose2(-0.04, 0.01, 0.0)
    robots = [Pose2(0.1 * k, 0.02 * k, math.remainder(0.05 * k, math.tau)) for k in range(200)]
    text = "".join(two_poses(k, robot.compose(mount), robot) for k, robot in enumerate(robots))
    assert scan_of(tmp_path, text).T_base_sensor == mount


def test_a_first_pose_that_a_slam_corrected_does_not_place_the_laser(tmp_path):
    robots = [Pose2(0.1 * k, 0.02 * k, 0.0) for k in range(200)]
    text = "".join(
        two_poses(k, Pose2(robot.x, 1.1 * robot.y, 0.001 * k), robot) for k, robot in enumerate(robots)
    )
    assert scan_of(tmp_path, text).T_base_sensor == Pose2.identity()


@pytest.mark.parametrize(
    ("beams", "step_deg", "last_deg"),
    [(180, 1.0, 89.0), (181, 1.0, 90.0), (360, 0.5, 89.5), (361, 0.5, 90.0)],
)
def test_beams_begin_at_the_right_and_are_evenly_spaced(tmp_path, beams, step_deg, last_deg):
    angles = np.degrees(scan_of(tmp_path, flaser(*[1.0] * beams)).angles_rad)
    assert angles[0] == pytest.approx(-90.0)
    assert np.diff(angles) == pytest.approx(step_deg)
    assert angles[-1] == pytest.approx(last_deg)


def test_a_robotlaser_line_says_itself_where_it_looks_and_how_far(tmp_path):
    odometry, scan = measured(tmp_path, ROBOTLASER)
    assert odometry.T_odom_base == Pose2(1.0, 2.0, 0.5)
    assert scan.angles_rad == pytest.approx([-1.5, -0.5, 0.5, 1.5])
    np.testing.assert_array_equal(scan.ranges_m, np.array([1.0, 2.0, np.inf, np.nan], dtype=np.float32))
    assert scan.T_base_sensor == Pose2(1.0, 2.0, 0.5).between(Pose2(1.1, 2.0, 0.5))


@pytest.mark.parametrize(
    ("longest", "limit"),
    [(7.5, 8.18), (8.19, 8.18), (8.5, 16.37), (20.0, 32.75), (40.0, 80.0), (81.83, 80.0)],
)
def test_the_range_limit_is_the_smallest_of_a_sick_that_nothing_exceeds(tmp_path, longest, limit):
    scan = scan_of(tmp_path, flaser(1.0, longest))
    assert scan.range_max_m == limit
    assert math.isinf(scan.ranges_m[1]) == (longest >= limit)


def test_a_range_limit_that_is_given_holds(tmp_path):
    assert scan_of(tmp_path, flaser(1.0, 5.0, 9.0), range_max_m=5.0).ranges_m.tolist() == [
        1.0,
        np.inf,
        np.inf,
    ]


def test_odometry_lines_are_played_on_demand(tmp_path):
    path = write(tmp_path, LOG)
    log = CarmenLog(path)
    assert [one.stamp_s for one in log] == [100.25, 100.25, 101.0, 101.0]
    assert (log.passed_over, log.progress) == ({"PARAM": 1, "ODOM": 1}, 1.0)
    assert log.held == {"WheelOdometry odom": 2, "Scan2D laser": 2}
    first = next(iter(CarmenLog(path, odom_lines=True)))
    assert (first.stamp_s, first.T_odom_base) == (99.5, Pose2(1.0, 2.0, 0.5))


def test_compressed_logs_are_the_same_log(tmp_path):
    plain = [repr(one) for one in measured(tmp_path, LOG)]
    assert [repr(one) for one in measured(tmp_path, gzip.compress(LOG.encode()))] == plain
    assert [repr(one) for one in measured(tmp_path, bz2.compress(LOG.encode()))] == plain


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": an empty file; expected a log"),
        ("PARAM a b host 0\n", ": not one FLASER, ROBOTLASER1 or ODOM line in it; expected a CARMEN log"),
        ("PARAM a b\nhello there\n", ":2: hello: expected the name of a CARMEN message, in capitals"),
        ("FLASER many 1 2\n", ':1: FLASER: the number of readings is "many"; expected a count'),
        ("FLASER -1 1 2\n", ':1: FLASER: the number of readings is "-1"; expected a count'),
        ("FLASER 180 1 2 3\n", ":1: FLASER: the number of readings is 180, but only 3 words follow"),
        (FLASER.replace("1.5", "1,5"), ':1: FLASER: range 0 is "1,5"; expected metres, 0 or more'),
        (FLASER.replace("1.5", "-1.5"), ':1: FLASER: range 0 is "-1.5"; expected metres, 0 or more'),
        (FLASER.replace("100.25", "inf"), ':1: FLASER: the time stamp is "inf"; expected a finite number'),
        (FLASER.replace(" host", ""), ":1: FLASER: words left on the line: 1; expected 2 (a host name"),
        (FLASER + FLASER.replace("2 0.5", "2 x"), ':2: FLASER: the odometry\'s theta is "x"'),
        (ODOM.replace("host", "host more"), ":1: ODOM: words left on the line: 3; expected 2"),
        (
            ROBOTLASER.replace(" 30 ", " 0 "),
            ":1: ROBOTLASER1: the maximum range is 0; expected metres above 0",
        ),
        (ROBOTLASER[:60] + "\n", ":1: ROBOTLASER1: ends before"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path, text, message):
    with pytest.raises(LogError) as caught:
        measured(tmp_path, text)
    assert f"some.clf{message}" in str(caught.value)
    assert not isinstance(caught.value, LogCutOff)


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(LogError, match=r"none\.clf: cannot be read \(no such file"):
        list(CarmenLog(tmp_path / "none.clf"))


@pytest.mark.parametrize("left", [3, 12, 30, 44])
def test_a_log_cut_in_a_line_is_told_after_what_is_whole(tmp_path, left):
    log, found = CarmenLog(write(tmp_path, FLASER + ODOM + FLASER[:left])), []
    with pytest.raises(LogCutOff, match="cut off"):
        found.extend(log)
    assert len(found) == 2


@pytest.mark.parametrize("compress", [gzip.compress, bz2.compress])
def test_a_cut_compressed_log_is_told_with_its_byte(tmp_path, compress):
    rng = np.random.default_rng(1)
    text = "".join(flaser(*rng.uniform(1, 8, 180).round(2)) for _ in range(2000)).encode()
    whole = compress(text)
    log, found = CarmenLog(write(tmp_path, whole[: len(whole) * 3 // 4])), []
    with pytest.raises(
        LogCutOff, match=f"cut off: the compressed file ends at byte {len(whole) * 3 // 4}, after"
    ):
        found.extend(log)
    assert found
    assert log.progress > 0.4


@pytest.mark.parametrize(("compress", "at"), [(gzip.compress, 10), (bz2.compress, 5)])
def test_damaged_compression_is_told_with_its_byte(tmp_path, compress, at):
    whole = bytearray(compress((FLASER * 2000).encode()))
    whole[at] = 0xFF
    with pytest.raises(LogError, match="its compression is damaged near byte"):
        measured(tmp_path, bytes(whole))


MUTATION = st.tuples(st.floats(0.0, 1.0), st.sampled_from(["cut", "drop", "write"]), st.binary(max_size=12))


@settings(deadline=None, max_examples=200)
@given(
    mutations=st.lists(MUTATION, max_size=4),
    compress=st.sampled_from([bytes, gzip.compress, bz2.compress]),
    outside=st.booleans(),
)
def test_a_mutated_log_is_read_or_is_a_log_error(tmp_path_factory, mutations, compress, outside):
    def mutated(content: bytes) -> bytes:
        for place, what, new in mutations:
            at = int(place * len(content))
            rest = b"" if what == "cut" else content[at + 5 * (what == "drop") :]
            content = content[:at] + new + rest
        return content

    content = mutated(compress(LOG.encode())) if outside else compress(mutated(LOG.encode()))
    path = write(tmp_path_factory.mktemp("fuzz"), content)
    try:
        found = list(CarmenLog(path, odom_lines=True))
    except LogError as fault:
        found = []
        told = str(fault)
        assert told.startswith(str(path))
        assert re.search(r"^:\d+: |byte \d+|an empty file|not one FLASER", told.removeprefix(str(path)))
    for one in found:
        assert math.isfinite(one.stamp_s)
        if isinstance(one, Scan2D):
            assert len(one.ranges_m) == len(one.angles_rad) == len(one.times_s)


@given(st.lists(st.tuples(st.floats(-1e9, 1e9), st.sampled_from("ab")), max_size=40))
def test_replay_time_never_goes_back_and_keeps_a_kind_apart(stamps):
    time, last, newest = ReplayTime(), -1.0, {}
    for stamp_s, kind in stamps:
        now = time.of(stamp_s, kind)
        assert now >= max(last, 0.0)
        assert now > newest.get(kind, -1.0)
        last = newest[kind] = now


def test_replay_time_is_the_logs_own_where_that_rises():
    time = ReplayTime()
    assert [time.of(stamp, "scan") for stamp in (5.0, 5.5, 7.25)] == [0.0, 0.5, 2.25]


def test_a_stamp_that_goes_back_is_held_and_a_clock_that_was_set_back_is_followed():
    time = ReplayTime()
    found = [time.of(stamp, "scan") for stamp in (10.0, 11.0, 10.5, 11.5, 3.0, 4.0)]
    assert found == pytest.approx([0.0, 1.0, 1.001, 1.5, 1.501, 2.5], abs=2e-3)


def test_odometry_and_scan_of_one_line_keep_one_stamp():
    time = ReplayTime()
    line = [time.of(stamp, kind) for stamp in (1.0, 0.5, 2.0) for kind in (WheelOdometry, Scan2D)]
    assert line[::2] == line[1::2]


@pytest.mark.skipif(not DATA, reason="EXPLORE_BT_DATA names no folder of recorded logs")
def test_a_real_log_is_read_whole_in_file_order():
    log = CarmenLog(Path(DATA) / "carmen" / "mit-csail.clf.bz2")
    scans = [one for one in log if isinstance(one, Scan2D)]
    assert len(scans) == 1988
    assert {(len(scan.ranges_m), scan.range_max_m) for scan in scans} == {(361, 80.0)}

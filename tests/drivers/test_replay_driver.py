from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers import Replay, ReplayOptions, Sim2d, Sim2dOptions
from explore_bt_drivers.replay import open_log
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import LogCutOff, LogError, UserError
from explore_bt.interfaces import RobotContext, RobotSnapshot, RunInfo, TickSnapshot
from explore_bt.recording import McapRecorder
from explore_bt.testing.driver_contract import DriverContract
from explore_bt.types import (
    Estimate,
    Imu,
    Measurement,
    MotionState,
    OccupancyGrid,
    Pose2,
    Scan2D,
    Score,
    Twist2,
    WheelOdometry,
)

WORLD = Path(__file__).parents[2] / "missions" / "worlds" / "room.yaml"
MOUNTING = Pose2(0.1, 0.0, 0.2)
POSITIONS = re.compile(r"^[^ ]+:\d+: |byte \d+|message \d+|not an MCAP file|of profile|robots are|not one ")
START = Pose2(1.25, -0.5, 2.0)


def carmen_log(folder: Path, stamps: list[float]) -> Path:
    path = folder / "drive.clf"
    path.write_text(
        "".join(f"FLASER 3 1 2 {1 + i / 100} 0 0 0 {i / 10} 0 0 {s} host 0\n" for i, s in enumerate(stamps))
    )
    return path


def replay(path: Path, **options: object) -> Replay:
    return Replay(ReplayOptions.model_validate({"log": path, **options}))


class TestReplay(DriverContract):
    """Of a log of ten seconds whose stamps go back now and then."""

    def make(self, tmp_path: Path) -> Replay:
        stamps = [round(100.0 + 0.1 * i - (0.35 if i % 7 == 0 else 0.0), 3) for i in range(100)]
        return replay(carmen_log(tmp_path, stamps))


def test_the_log_is_played_in_mission_time_and_then_there_is_silence(tmp_path):
    driver = replay(carmen_log(tmp_path, [100.0, 101.0, 103.0]))
    driver.setup(RobotContext())
    assert [one.stamp_s for one in driver.read()] == [0.0, 0.0]
    driver.clock.wait_until(2.0)
    driver.command(Twist2(0.5, 0.0))
    driver.stop()
    assert [one.stamp_s for one in driver.read()] == [1.0, 1.0]
    driver.clock.wait_until(50.0)
    assert [one.stamp_s for one in driver.read()] == [3.0, 3.0]
    assert (driver.clock.now_s(), driver.read(), driver.progress) == (50.0, [], 1.0)


def test_recorded_is_the_whole_log_with_its_own_stamps(tmp_path):
    stamps = [100.0, 100.2, 100.1, 100.4]
    found = list(replay(carmen_log(tmp_path, stamps)).recorded())
    assert [one.log_stamp_s for one in found[::2]] == stamps
    assert all(isinstance(one.measurement, WheelOdometry) for one in found[::2])
    assert all(isinstance(one.measurement, Scan2D) for one in found[1::2])
    assert all(a.measurement.stamp_s <= b.measurement.stamp_s for a, b in pairwise(found))


def test_a_log_that_cannot_be_read_is_told_at_set_up(tmp_path):
    with pytest.raises(LogError, match=r"none\.clf: cannot be read"):
        replay(tmp_path / "none.clf").setup(RobotContext())


def test_what_is_wrong_further_on_is_told_when_it_comes(tmp_path):
    path = carmen_log(tmp_path, [1.0, 2.0])
    path.write_text(path.read_text() + "FLASER x\n")
    driver = replay(path)
    driver.setup(RobotContext())
    driver.clock.wait_until(5.0)
    with pytest.raises(LogError, match=r"drive\.clf:3: FLASER"):
        driver.read()


def test_a_database_is_sent_to_its_folder(tmp_path):
    path = tmp_path / "bag_0.db3"
    path.write_bytes(b"SQLite format 3\x00" + bytes(100))
    with pytest.raises(LogError, match=r"part of a ROS 2 bag, give the bag's folder"):
        open_log(ReplayOptions(log=path))


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> tuple[Path, list[Measurement]]:
    """A drive of sim2d, recorded, and what was shown to the recorder."""
    folder = tmp_path_factory.mktemp("recording")
    driver = Sim2d(Sim2dOptions.model_validate({"world": WORLD}))
    driver.setup(RobotContext())
    recorder = McapRecorder(McapRecorder.Options())
    recorder.open(RunInfo("room", "", "", 0, "1", folder, {"anna": ()}, {"anna": 0.31}))
    grid = OccupancyGrid(np.full((4, 4), -1, dtype=np.int8), 0.05, (0.0, 0.0))
    shown: list[Measurement] = []
    for tick in range(60):
        driver.command(Twist2(0.2, 0.3))
        driver.clock.wait_until(0.1 * (tick + 1))
        measured = tuple(
            replace(one, T_base_sensor=MOUNTING) if isinstance(one, Scan2D) else one for one in driver.read()
        )
        shown += measured
        snapshot = RobotSnapshot(
            robot="anna",
            estimate=Estimate(0.1 * tick, START if tick == 0 else driver.truth().pose()),
            grid=grid,
            scan=None,
            path=None,
            motion=MotionState(),
            gate_reason="",
            nodes=(),
            blackboard={},
            score=Score(),
            measured=measured,
        )
        recorder.on_tick(TickSnapshot(tick, 0.1 * (tick + 1), (snapshot,)))
    recorder.close(None)
    return folder / "recording.mcap", shown


@pytest.fixture(scope="module")
def whole_file(recording) -> Path:
    return recording[0]


def test_a_recording_gives_back_all_that_was_measured_in_its_order(recording):
    path, shown = recording
    found = list(open_log(ReplayOptions(log=path)))
    assert [(type(one), one.stamp_s) for one in found] == [(type(one), one.stamp_s) for one in shown]
    assert {type(one) for one in found} == {Scan2D, Imu, WheelOdometry}
    for one, true in zip(found, shown, strict=True):
        if isinstance(true, Scan2D):
            np.testing.assert_allclose(one.ranges_m, true.ranges_m, atol=2.6e-4)
            assert (one.T_base_sensor, one.range_max_m) == (MOUNTING, true.range_max_m)


def test_a_replayed_recording_starts_where_its_robot_started_and_is_as_wide(recording):
    driver = Replay(ReplayOptions(log=recording[0]))
    driver.setup(RobotContext())
    assert driver.start.as_array() == pytest.approx(START.as_array(), abs=2e-4)
    assert driver.footprint_radius_m == 0.31


def test_a_shorter_range_turns_what_is_farther_into_nothing(recording):
    for scan in open_log(ReplayOptions(log=recording[0], range_max=1.0)):
        if isinstance(scan, Scan2D):
            assert scan.range_max_m == 1.0
            assert not (np.isfinite(scan.ranges_m) & (scan.ranges_m >= 1.0)).any()


def test_a_robot_that_is_not_in_the_recording_is_told(recording):
    with pytest.raises(LogError, match='there is no robot "bob" in it; robots are anna'):
        list(open_log(ReplayOptions(log=recording[0], robot="bob")))


def test_a_cut_recording_is_told_after_its_whole_chunks(recording, tmp_path):
    cut, found = tmp_path / "recording.mcap", []
    cut.write_bytes(recording[0].read_bytes()[: recording[0].stat().st_size // 2])
    with pytest.raises(LogCutOff, match=r"cut off after byte \d+: ends at"):
        found.extend(open_log(ReplayOptions(log=cut)))
    assert found


@settings(deadline=None, max_examples=60)
@given(place=st.floats(0.0, 0.999), new=st.binary(min_size=1, max_size=8), cut=st.booleans())
def test_a_mutated_recording_is_read_or_is_a_user_error(whole_file, tmp_path_factory, place, new, cut):
    content = whole_file.read_bytes()
    at = int(place * len(content))
    path = tmp_path_factory.mktemp("fuzz") / "recording.mcap"
    path.write_bytes(content[:at] + new + (b"" if cut else content[at + len(new) :]))
    found, told = 0, ""
    try:
        found = sum(1 for _ in open_log(ReplayOptions(log=path)))
    except UserError as fault:
        told = str(fault)
    assert found or told.startswith(str(path))
    assert not told or POSITIONS.search(told), told

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from mcap.reader import make_reader

from explore_bt.interfaces import Event
from explore_bt.recording import McapRecorder, decode_grid, read_recording
from explore_bt.types import UNKNOWN, OccupancyGrid
from tests.report.flat_drive import make_drive


def record(drive, **options):
    drive.show_to(McapRecorder(McapRecorder.Options(**options)))
    return read_recording(drive.run.folder / "recording.mcap")


@pytest.fixture(scope="module")
def ten_minutes(recorded_drive):
    return read_recording(recorded_drive.run.folder / "recording.mcap")


@pytest.fixture(scope="module")
def short_drive(recorded_drive):
    return replace(recorded_drive, ticks=recorded_drive.ticks[:400])


def known_part(grid: OccupancyGrid):
    known = grid.cells != UNKNOWN
    rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    return grid.cells[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]


def test_the_run_message_tells_mission_hash_seed_and_tree(ten_minutes, recorded_drive):
    run = recorded_drive.run
    assert ten_minutes.is_complete
    assert ten_minutes.info["mission_text"] == run.mission_text
    assert ten_minutes.info["mission_sha256"] == run.mission_sha256
    assert ten_minutes.info["seed"] == run.seed
    assert [node["path"] for node in ten_minutes.info["trees"]["robot"]] == [
        n.path for n in run.trees["robot"]
    ]
    assert ten_minutes.robots == ("robot",)


def test_key_frames_and_deltas_give_back_the_tree_at_every_tick(ten_minutes, recorded_drive):
    changes = {round(m.stamp_s, 3): m.value for m in ten_minutes.messages("/robot/tree")}
    shown: dict[int, tuple[str, str]] = {}
    for tick in recorded_drive.ticks:
        for node in changes.get(round(tick.stamp_s, 3), {"nodes": ()})["nodes"]:
            shown[node["id"]] = (node["status"], node["message"])
        assert [shown[i] for i in range(len(shown))] == [(n.status, n.message) for n in tick.robots[0].nodes]


def test_a_key_frame_comes_every_five_seconds_so_that_one_can_start_anywhere(ten_minutes):
    for topic in ("/robot/tree", "/robot/blackboard"):
        stamps = [m.stamp_s for m in ten_minutes.messages(topic) if m.value["key_frame"]]
        assert max(np.diff(stamps)) <= 5.0 + 1e-6


def test_blackboard_differences_add_up_to_the_last_values(ten_minutes, recorded_drive):
    board: dict[str, object] = {}
    for message in ten_minutes.messages("/robot/blackboard"):
        board |= message.value["set"]
    last = recorded_drive.ticks[-1].robots[0].blackboard
    assert board.keys() == last.keys()
    assert board["goal"]["reason"] == last["goal"].reason
    assert board["left_m"] == pytest.approx(last["left_m"], abs=1e-6)


def test_an_entry_that_leaves_the_blackboard_is_told_once(short_drive, tmp_path):
    drive = short_drive.in_folder(tmp_path)
    tick = drive.ticks[20]
    emptied = replace(tick, robots=(replace(tick.robots[0], blackboard={}),))
    recording = record(replace(drive, ticks=[*drive.ticks[:20], emptied, replace(emptied, stamp_s=2.1)]))
    removed = [m.value["removed"] for m in recording.messages("/robot/blackboard") if m.value["removed"]]
    assert [sorted(keys) for keys in removed] == [["goal", "left_m", "path", "visited"]]


def test_poses_come_back_to_a_tenth_of_a_millimetre(ten_minutes, recorded_drive):
    poses = [m.value["pose"] for m in ten_minutes.messages("/robot/pose")]
    for tick, pose in list(zip(recorded_drive.ticks, poses, strict=False))[::97]:
        expected = tick.robots[0].estimate.T_map_base
        assert pose["position"]["x"] == pytest.approx(expected.x, abs=1e-4)
        turned = 2.0 * math.atan2(pose["orientation"]["z"], pose["orientation"]["w"])
        assert math.cos(turned - expected.yaw_rad) > 1.0 - 1e-8


def test_the_last_map_is_the_last_map(ten_minutes, recorded_drive):
    last = list(ten_minutes.messages("/robot/map"))[-1]
    grid, expected = decode_grid(last.value), recorded_drive.ticks[-1].robots[0].grid
    np.testing.assert_array_equal(grid.cells, known_part(expected))
    rows, cols = np.nonzero(expected.cells == 100)
    x, y = expected.center_of(int(rows[0]), int(cols[0]))
    assert grid.value_at(x, y) == 100
    assert grid.revision == expected.revision


def test_maps_and_scans_keep_their_distance(ten_minutes):
    for topic, period_s in (("/robot/map", 2.0), ("/robot/scan", 0.5)):
        stamps = [m.stamp_s for m in ten_minutes.messages(topic)]
        assert len(stamps) > 50
        assert min(np.diff(stamps[:-1])) >= period_s - 1e-6  # the last map is written at the end


def test_invalid_returns_and_open_beams_stay_apart(ten_minutes, recorded_drive):
    ranges = next(ten_minutes.messages("/robot/scan")).value["ranges"]
    expected = recorded_drive.ticks[0].robots[0].scan.ranges_m
    assert [r is None for r in ranges] == list(np.isnan(expected))
    assert [r == math.inf for r in ranges] == list(np.isposinf(expected))
    finite = np.isfinite(expected)
    np.testing.assert_allclose(
        np.array([r for r in ranges if r not in (None, math.inf)]), expected[finite], atol=0.00501
    )


def test_every_visited_waypoint_is_told_once_with_its_reason(ten_minutes, recorded_drive):
    visited = recorded_drive.ticks[-1].robots[0].blackboard["visited"]
    told = [m.value for m in ten_minutes.messages("/robot/visited")]
    assert [message["index"] for message in told] == list(range(len(visited)))
    assert [message["reason"] for message in told] == [waypoint.reason for waypoint in visited]


def test_the_gate_is_told_when_it_brakes_and_when_it_lets_go(ten_minutes):
    assert [m.value["braking"] for m in ten_minutes.messages("/robot/gate")] == [True, False]


def test_events_carry_level_source_and_words(ten_minutes, recorded_drive):
    told = [m.value for m in ten_minutes.messages("/events")]
    assert [message["message"] for message in told] == [event.message for event in recorded_drive.events]
    assert {message["level"] for message in told} == {2, 3, 4}
    assert told[2]["name"] == "robot/slam"


def test_the_result_leaves_out_what_a_wall_clock_measured(ten_minutes, recorded_drive):
    result = next(ten_minutes.messages("/result")).value
    assert result["reason"] == recorded_drive.result.reason
    assert result["slam"].keys() == {"keyframes", "loop_closures", "graph_error_m"}
    assert "wall_time_s" not in result


def test_the_same_run_gives_the_same_bytes(short_drive, tmp_path):
    contents = []
    for name, wall_time_s in (("a", 10.0), ("b", 99.0)):
        (tmp_path / name).mkdir()
        drive = short_drive.in_folder(tmp_path / name)
        record(replace(drive, result=replace(drive.result, wall_time_s=wall_time_s)))
        contents.append((tmp_path / name / "recording.mcap").read_bytes())
    assert contents[0] == contents[1]


def test_ten_minutes_stay_below_ten_megabytes(recorded_drive):
    assert recorded_drive.result.mission_time_s > 595.0
    assert (recorded_drive.run.folder / "recording.mcap").stat().st_size < 10e6


def test_a_large_map_that_never_rests_stays_below_ten_megabytes(short_drive, tmp_path):
    rng = np.random.default_rng(1)
    cells = np.where(rng.random((900, 900)) < 0.05, 100, 0).astype(np.int8)
    robot, ticks = short_drive.ticks[0].robots[0], []
    for index in range(600):
        cells = cells.copy()
        cells[rng.integers(0, 900, 500), rng.integers(0, 900, 500)] = -1
        grid = OccupancyGrid(cells, 0.05, (0.0, 0.0), index)
        ticks.append(
            replace(
                short_drive.ticks[0], index=index, stamp_s=float(index), robots=(replace(robot, grid=grid),)
            )
        )
    record(replace(short_drive.in_folder(tmp_path), ticks=ticks))
    assert (tmp_path / "recording.mcap").stat().st_size < 10e6


def test_two_robots_have_a_namespace_each(tmp_path):
    drive = make_drive(tmp_path, speed_mps=0.8, robots=("anna", "bert"))
    recording = record(replace(drive, ticks=drive.ticks[:100]))
    assert recording.robots == ("anna", "bert")
    assert len(list(recording.messages("/anna/pose"))) == len(list(recording.messages("/bert/pose"))) == 100


def test_messages_can_be_asked_for_by_time(ten_minutes):
    stamps = [m.stamp_s for m in ten_minutes.messages("/robot/pose", 100.0, 110.0)]
    assert len(stamps) == 101
    assert stamps[0] == pytest.approx(100.0)


def test_nothing_recorded_is_not_finite_json(ten_minutes):
    assert all(isinstance(message.value, dict) for message in ten_minutes.messages())


def test_a_pose_that_is_not_a_number_is_survived(short_drive, tmp_path):
    tick = short_drive.ticks[0]
    robot = tick.robots[0]
    lost = replace(
        robot, estimate=replace(robot.estimate, T_map_base=replace(robot.estimate.T_map_base, x=math.nan))
    )
    recording = record(replace(short_drive.in_folder(tmp_path), ticks=[replace(tick, robots=(lost,))]))
    assert next(recording.messages("/robot/pose")).value["pose"]["position"]["x"] is None


def test_foreign_text_with_a_lone_surrogate_is_survived(short_drive, tmp_path):
    event = Event(1.0, "robot", "info", "driver", 'odd \udc80 "name"\n')
    recording = record(replace(short_drive.in_folder(tmp_path), events=[event]))
    assert next(recording.messages("/events")).value["message"] == event.message


def test_the_library_reads_it_by_index_with_its_checksums(recorded_drive):
    with (recorded_drive.run.folder / "recording.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary.statistics.chunk_count > 590
        assert sum(1 for _ in reader.iter_messages(topics=["/robot/pose"])) == len(recorded_drive.ticks)


def test_closing_twice_or_before_opening_does_no_harm(short_drive, tmp_path):
    recorder = McapRecorder(McapRecorder.Options())
    recorder.close(None)
    short_drive.in_folder(tmp_path).show_to(recorder)
    before = (tmp_path / "recording.mcap").read_bytes()
    recorder.close(short_drive.result)
    assert (tmp_path / "recording.mcap").read_bytes() == before


KILLED = """
import os, pathlib, signal, sys
from tests.report.flat_drive import make_drive
from explore_bt.recording import McapRecorder

drive = make_drive(pathlib.Path(sys.argv[1]), speed_mps=2.0)
recorder = McapRecorder(McapRecorder.Options())
recorder.open(drive.run)
for tick in drive.ticks[:120]:
    recorder.on_tick(tick)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_process_leaves_all_but_the_last_second(tmp_path):
    done = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], cwd=os.getcwd(), check=False)
    assert done.returncode == -signal.SIGKILL
    recording = read_recording(tmp_path / "recording.mcap")
    assert recording.damage.startswith("cut off after byte ")
    assert 10.9 <= recording.duration_s <= 11.9

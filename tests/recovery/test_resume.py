from __future__ import annotations

import itertools
import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from explore_bt.checkpoint import CheckpointError
from explore_bt.cli import app
from explore_bt.errors import UserError
from explore_bt.recording import read_recording
from explore_bt.recovery import find_broken_off
from explore_bt.types import Outcome, Result, Waypoint

from .drives import CutAt, drive, resume

KILLED_S = 13.3


def result_of(folder: Path) -> dict[str, object]:
    found: dict[str, object] = json.loads((folder / "result.json").read_text())
    return found


@pytest.fixture(scope="module")
def resumed(runs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The cut run, killed once more at 20 s, and then driven to its end."""
    folder = tmp_path_factory.mktemp("resumed")
    shutil.copytree(runs / "cut", folder / "first")
    resume(folder / "first", cut=CutAt(200, folder / "run"))
    resume(folder / "run")
    return folder / "run"


def test_a_run_killed_twice_ends_as_the_unbroken_one(runs: Path, resumed: Path) -> None:
    whole, found = result_of(runs / "whole"), result_of(resumed)
    assert (found["outcome"], found["reason"]) == (whole["outcome"], whole["reason"])
    assert found["coverage"] == pytest.approx(whole["coverage"], abs=0.01)
    assert found["ate_rmse_m"] == pytest.approx(whole["ate_rmse_m"], abs=0.02)
    assert found["contacts"] == 0


def test_way_and_time_go_on_where_they_stood(runs: Path, resumed: Path) -> None:
    whole, found = result_of(runs / "whole"), result_of(resumed)
    assert found["path_length_m"] == pytest.approx(whole["path_length_m"], abs=0.5)
    assert whole["mission_time_s"] < found["mission_time_s"] < whole["mission_time_s"] + 4.0
    assert found["distance_to_home_m"] < 0.1


def test_one_recording_tells_of_all_parts_without_a_gap(resumed: Path) -> None:
    recording = read_recording(resumed / "recording.mcap")
    assert recording.is_complete
    stamps = [message.stamp_s for message in recording.messages("/robot/pose")]
    assert stamps == sorted(stamps)
    assert stamps[0] < 0.2
    assert max(later - earlier for earlier, later in itertools.pairwise(stamps)) <= 1.11
    seams = [
        message.value["message"]
        for message in recording.messages("/events")
        if "begins" in message.value["message"]
    ]
    assert [words.split(",")[0] for words in seams] == ["part 2 begins", "part 3 begins"]
    assert len(list(recording.messages("/result"))) == len(list(recording.messages("/run"))) == 1


def test_what_was_recorded_before_is_kept_to_the_byte(runs: Path, resumed: Path) -> None:
    before = list(read_recording(runs / "cut" / "recording.mcap").raw_messages())
    after = list(read_recording(resumed / "recording.mcap").raw_messages())
    assert after[: len(before)] == before


def test_the_report_shows_the_whole_drive(resumed: Path) -> None:
    page = (resumed / "report.html").read_text()
    data = page.split('id="data"')[1].split(">", 1)[1].split("</script>")[0]
    stamps = json.loads(data)["robots"][0]["t"]
    assert stamps[0] < 1.0
    assert stamps[-1] == pytest.approx(result_of(resumed)["mission_time_s"], abs=0.2)


def test_true_and_estimated_way_cover_the_whole_mission(resumed: Path) -> None:
    for name in ("trajectory.tum", "truth.tum"):
        stamps = [float(line.split()[0]) for line in (resumed / name).read_text().splitlines()]
        assert stamps == sorted(stamps)
        assert stamps[0] < 0.2
        assert len(stamps) > 8 * result_of(resumed)["mission_time_s"]


def test_an_explored_run_has_nothing_left_to_resume(resumed: Path) -> None:
    assert not (resumed / "checkpoint").exists()
    with pytest.raises(UserError, match="nothing left to resume"):
        find_broken_off(resumed)


def test_the_strategy_remembers_up_to_the_last_second(cut: Path) -> None:
    robot = find_broken_off(cut).run.robots["robot"]
    visited = robot.memory.blackboard["visited"]
    assert isinstance(visited, tuple)
    assert isinstance(visited[-1], Waypoint)
    assert len(visited) == 2  # the second was reached at 11.6 s, after the last checkpoint
    assert robot.resumption.stamp_s > KILLED_S - 1.1
    assert robot.resumption.true_pose is not None
    assert robot.resumption.pose.distance_to(robot.resumption.true_pose) < 0.05


def test_without_its_recording_a_run_goes_on_from_the_checkpoint(cut: Path) -> None:
    (cut / "recording.mcap").unlink()
    broken = find_broken_off(cut)
    robot = broken.run.robots["robot"]
    assert robot.resumption.stamp_s == pytest.approx(10.0)
    assert any("is lost" in note for note in broken.notes)
    assert len(robot.memory.blackboard["visited"]) == 1  # type: ignore[arg-type]  # as then, not as at the end


def test_the_recording_of_another_run_is_not_used(cut: Path, mission: Path, tmp_path: Path) -> None:
    drive(mission, tmp_path / "other", "limits.time=1 s", seed=3)
    shutil.copy(tmp_path / "other" / "recording.mcap", cut / "recording.mcap")
    broken = find_broken_off(cut)
    assert broken.recording is None
    assert any("belongs to another run" in note for note in broken.notes)


def test_a_mission_that_has_changed_goes_on_as_it_was(cut: Path, mission: Path) -> None:
    trees = mission.with_name("trees.yaml")
    before = trees.read_text()
    try:
        trees.write_text("nothing that could be read as a mission: [")
        broken = find_broken_off(cut)
    finally:
        trees.write_text(before)
    assert any("trees.yaml changed since the run began" in note for note in broken.notes)
    assert broken.mission.sha256 == broken.run.memory.origin.sha256


def test_a_damaged_checkpoint_is_named_and_the_one_before_is_taken(cut: Path) -> None:
    newest = sorted(cut.glob("checkpoint/0*"))[-1]
    slam = newest / "robot" / "slam" / "slam.npz"
    slam.write_bytes(slam.read_bytes()[:-5])
    broken = find_broken_off(cut)
    assert broken.run.memory.stamp_s == pytest.approx(5.0)
    assert [note for note in broken.notes if f"{newest} is not used: robot/slam/slam.npz is damaged" in note]


@pytest.mark.parametrize("damage", ["", "half", "0" * 64 + "\n{}"])
def test_damaged_notes_of_the_last_second_cost_only_that(cut: Path, damage: str) -> None:
    file = cut / "checkpoint" / "recent.json"
    text = file.read_text()
    file.write_text(text[: len(text) // 2] if damage == "half" else damage)
    robot = find_broken_off(cut).run.robots["robot"]
    assert robot.resumption.stamp_s > KILLED_S - 1.1
    assert len(robot.memory.blackboard["visited"]) == 1  # type: ignore[arg-type]  # of the checkpoint


def test_without_a_whole_checkpoint_the_way_out_is_named(cut: Path) -> None:
    for manifest in cut.glob("checkpoint/0*/manifest.json"):
        manifest.unlink()
    with pytest.raises(CheckpointError, match="explore-bt recover"):
        find_broken_off(cut)


def test_a_run_stopped_by_hand_goes_on(mission: Path, tmp_path: Path) -> None:
    stopped = drive(mission, tmp_path / "run", stop_at=8.0)
    assert stopped.outcome is Outcome.STOPPED
    ended = resume(tmp_path / "run")
    assert ended.outcome is Outcome.EXPLORED
    assert ended.path_length_m == pytest.approx(6.8, abs=0.5)


def test_a_spent_budget_wants_more_and_then_goes_on(mission: Path, tmp_path: Path) -> None:
    spent = drive(mission, tmp_path / "run", "limits.time=6 s")
    assert spent.outcome is Outcome.BUDGET
    with pytest.raises(UserError, match=r"limits\.time='40 min'"):
        find_broken_off(tmp_path / "run")
    more: Result = resume(tmp_path / "run", "limits.time=9 s")
    assert more.outcome is Outcome.BUDGET
    assert 9.0 <= more.mission_time_s < 12.0
    broken = find_broken_off(tmp_path / "run", ["limits.time=3 min"])
    assert broken.mission.limits.time_s == 180.0
    assert "over_budget" not in broken.run.robots["robot"].memory.blackboard


@pytest.mark.parametrize("name", ["nowhere", "empty"])
def test_a_folder_without_a_run_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "empty").mkdir()
    shown = CliRunner().invoke(app, ["resume", str(tmp_path / name)])
    assert shown.exit_code == 2
    assert "is no run folder" in shown.stderr


def test_the_command_says_what_it_does(runs: Path, cut: Path) -> None:
    shown = CliRunner().invoke(app, ["resume", str(cut), "--headless", "--set", "limits.time=14 s"])
    assert shown.exit_code == 1, shown.output
    assert "goes on at 13 s, part 2" in shown.stdout
    assert "budget" in shown.stdout

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from typer.testing import CliRunner, Result

from explore_bt.cli import app
from explore_bt.interfaces import TickSnapshot
from explore_bt.maps import read_map
from explore_bt.recording import read_recording
from explore_bt.recovery import moments_of, recover
from explore_bt.types import FREE, Outcome


def invoke(*words: object) -> Result:
    return CliRunner().invoke(app, ["recover", *map(str, words)])


def free_m2(folder: Path) -> float:
    return float(np.count_nonzero(read_map(folder / "map.yaml").cells == FREE)) * 0.05**2


def test_a_cut_run_becomes_the_folder_of_a_run(cut: Path, tmp_path: Path) -> None:
    saved = recover(cut, tmp_path / "saved")
    assert saved.result.outcome is Outcome.CUT
    assert saved.stamp_s == pytest.approx(13.2, abs=1.1)
    names = {each.name for each in saved.folder.iterdir()}
    assert names >= {
        "recording.mcap",
        "map.yaml",
        "trajectory.tum",
        "truth.tum",
        "report.html",
        "result.json",
    }
    assert saved.result.ate_rmse_m is not None
    assert saved.result.ate_rmse_m < 0.02


def test_the_saved_recording_is_whole_and_opens_elsewhere(cut: Path, tmp_path: Path) -> None:
    torn, saved = read_recording(cut / "recording.mcap"), recover(cut, tmp_path / "saved")
    whole = read_recording(saved.folder / "recording.mcap")
    assert torn.damage
    assert whole.is_complete
    assert list(whole.raw_messages()) == list(torn.raw_messages())
    with (saved.folder / "recording.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(list(torn.raw_messages()))


def test_map_and_way_reach_to_the_last_recorded_second(cut: Path, tmp_path: Path) -> None:
    saved = recover(cut, tmp_path / "saved")
    last_s = float((saved.folder / "trajectory.tum").read_text().splitlines()[-1].split()[0])
    assert saved.stamp_s - last_s < 0.2


def test_of_a_recording_alone_the_recorded_map_is_saved(cut: Path, tmp_path: Path) -> None:
    from_run = recover(cut, tmp_path / "run")
    alone = recover(cut / "recording.mcap", tmp_path / "alone")
    assert alone.result.slam == {}
    assert free_m2(alone.folder) == pytest.approx(free_m2(from_run.folder), rel=0.05)


def test_ticks_come_back_as_the_sinks_saw_them(runs: Path) -> None:
    moments = list(moments_of(read_recording(runs / "whole" / "recording.mcap")))
    ticks = [each for each in moments if isinstance(each, TickSnapshot)]
    stamps = [tick.stamp_s for tick in ticks]
    assert stamps == sorted(set(stamps))
    last = ticks[-1].robots[0]
    told = json.loads((runs / "whole" / "result.json").read_text())
    assert last.score.distance_m == pytest.approx(told["path_length_m"], abs=0.01)
    assert last.true_pose is not None
    assert last.estimate.T_map_base.distance_to(last.true_pose) < 0.02
    assert len(last.blackboard["visited"]) >= 2  # type: ignore[arg-type]  # a tuple of waypoints
    assert {node.status for node in last.nodes} <= {"success", "failure", "running", "idle"}


def test_the_command_never_overwrites_unless_told(cut: Path) -> None:
    target = cut.with_name("cut-recovered")
    first = invoke(cut)
    assert first.exit_code == 0, first.output
    assert f"{target}/report.html" in first.stdout.replace("\n", "")
    assert "ends at" in first.stdout
    again = invoke(cut)
    assert again.exit_code == 2
    assert "--overwrite replaces it" in again.stderr
    assert invoke(cut, "--overwrite").exit_code == 0
    assert {each.name for each in cut.parent.iterdir()} == {"cut", "cut-recovered"}


def test_the_run_itself_is_no_place_for_what_is_saved(cut: Path) -> None:
    for out in (cut, cut.parent):
        shown = invoke(cut, "--out", out, "--overwrite")
        assert shown.exit_code == 2
        assert "the run itself" in shown.stderr


def test_where_nothing_can_be_read_nothing_is_left_behind(tmp_path: Path) -> None:
    (tmp_path / "recording.mcap").write_bytes(b"no recording")
    shown = invoke(tmp_path / "recording.mcap")
    assert shown.exit_code == 2
    assert "not an MCAP file" in shown.stderr
    assert [each.name for each in tmp_path.iterdir()] == ["recording.mcap"]

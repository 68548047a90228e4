"""A whole mission with every leaf that drives played by a script."""

from __future__ import annotations

import json
from pathlib import Path

from explore_bt.mission import load_mission, with_mocks
from explore_bt.plugin import Registry
from explore_bt.recording import McapRecorder, read_recording
from explore_bt.report import ReportSink
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Outcome
from tests.missions.conftest import MISSIONS, Watcher

MOCKS = """\
format: explore-bt-mocks/1
mocks:
  - leaf: "*/find_view"
    ticks: [success*3, failure]
    at_end: last
    set: {goal: [1 m, 2 m, 90 deg]}
  - leaf: "*/drive_to"
    ticks: [running*10, success, running*5, failure]
    say: no way through the door
    set: {reached: $goal, failure: held}
  - leaf: "*/reach_goal/fallback/drive_to"
    after: 1 s
  - {leaf: "*/back_out", after: 0.5 s}
  - {leaf: "*/make_way", ticks: [failure]}
  - {leaf: "*/leave_pocket", ticks: [failure]}
"""


def test_a_shipped_mission_runs_through_its_branches_without_a_wheel_turning(
    tmp_path: Path, registry: Registry
) -> None:
    (tmp_path / "mocks.yaml").write_text(MOCKS)
    whole = load_mission(MISSIONS / "00_room.yaml", registry, ["slam=ground_truth"])
    mission = with_mocks(whole, tmp_path / "mocks.yaml")
    assert mission.sha256 != whole.sha256
    watcher, out = Watcher(), tmp_path / "run"
    sinks = [watcher, McapRecorder(McapRecorder.Options()), ReportSink(ReportSink.Options())]
    result = run_mission(mission, registry=registry, out=out, seed=0, sinks=sinks, stop=StopFlag())
    assert (result.outcome, result.path_length_m) == (Outcome.EXPLORED, 0.0)
    assert len(watcher.ticks[-1].robots[0].blackboard["visited"]) == 4  # the start and three goals
    told = [event.message for event in watcher.events if event.source == "recovery"]
    assert "make_way, for drive_to: no way through the door" in told

    mocked = set(json.loads((out / "result.json").read_text())["mocked"])
    assert {path.rpartition("/")[2] for path in mocked} == {
        "find_view", "drive_to", "back_out", "make_way", "leave_pocket"
    }  # fmt: skip
    recording = read_recording(out / "recording.mcap")
    infos = recording.info["trees"]["robot"]
    assert {node["path"] for node in infos if node["is_mocked"]} == mocked
    assert set(next(recording.messages("/result")).value["mocked"]) == mocked
    assert "<b>Dry run:</b> scripts played" in (out / "report.html").read_text()

from __future__ import annotations

import logging
import shutil
import textwrap
from pathlib import Path

import pytest

from explore_bt.checkpoint import Checkpoint, CheckpointError, CheckpointStore, Draft
from explore_bt.plugin import INLINE_FILE
from explore_bt.recovery import find_broken_off
from explore_bt.runtime import CHECKPOINTS, checkpoint_keeper
from explore_bt.types import Outcome

from .drives import drive, resume

FOREIGN = """
    from dataclasses import dataclass

    from explore_bt import hookimpl
    from explore_bt.tree import Key, Leaf, Output, Status


    @dataclass(frozen=True)
    class Known:
        number: int


    @dataclass(frozen=True)
    class Foreign:
        number: int


    class Writes(Leaf):
        '''Writes a value of a declared class, and one of another.'''

        type_key = "writes"
        values = (Known,)
        known = Output(Known, default=Key("known"), doc="declared")
        foreign = Output(Foreign, default=Key("foreign"), doc="not declared")

        def update(self):
            self.known, self.foreign = Known(3), Foreign(4)
            return Status.RUNNING


    @hookimpl
    def explore_bt_register():
        return [Writes]
"""


@pytest.fixture
def foreign(mission: Path, tmp_path: Path) -> Path:
    """The mission with a leaf of somebody else's as its tree."""
    folder = Path(shutil.copytree(mission.parent, tmp_path / "foreign"))
    (folder / INLINE_FILE).write_text(textwrap.dedent(FOREIGN))
    (folder / "trees.yaml").write_text("format: explore-bt/1\ntrees: {main: {writes: {}}}\n")
    text = (folder / "rooms.yaml").read_text()
    (folder / "rooms.yaml").write_text(
        text.replace("params:\n  pause: {type: duration, default: 0.5 s}\n", "")
    )
    return folder / "rooms.yaml"


def test_an_entry_of_an_undeclared_class_is_left_out_and_named_once(
    foreign: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING, "explore_bt"):
        drive(foreign, tmp_path / "run", "limits.time=4 s")
    lines = [record.message for record in caplog.records if "leave $foreign out" in record.message]
    assert len(lines) == 1
    assert "a Foreign cannot be kept: nobody has declared that class" in lines[0]
    board = find_broken_off(tmp_path / "run", ["limits.time=9 s"]).run.robots["robot"].memory.blackboard
    assert "foreign" not in board
    assert getattr(board["known"], "number", None) == 3


def test_how_often_checkpoints_are_written_changes_nothing_of_the_run(
    mission: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = []
    for name, period_s in (("often", 0.5), ("never", 1e9)):
        monkeypatch.setattr(checkpoint_keeper, "PERIOD_S", period_s)
        drive(mission, tmp_path / name, "limits.time=5 s")
        recordings.append((tmp_path / name / "recording.mcap").read_bytes())
    assert recordings[0] == recordings[1]


def test_a_full_disk_costs_the_checkpoints_and_not_the_mission(
    mission: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: Draft) -> Checkpoint:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Draft, "commit", full)
    result = drive(mission, tmp_path / "run", "limits.time=3 s")
    assert result.outcome is Outcome.BUDGET
    with pytest.raises(CheckpointError, match="nothing to go on from"):
        find_broken_off(tmp_path / "run")


def test_no_second_process_touches_a_run_at_work(mission: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    drive(mission, run, "limits.time=2 s")
    before = (run / "recording.mcap").read_bytes()
    with (
        CheckpointStore(run / CHECKPOINTS).locked(),
        pytest.raises(CheckpointError, match="another process is at work"),
    ):
        resume(run, "limits.time=3 s")
    assert (run / "recording.mcap").read_bytes() == before

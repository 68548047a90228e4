"""``explore-bt export --btlog``; tables and video have tests of their own beside their sources."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from explore_bt.cli import app
from explore_bt.recording import McapRecorder, btlog, read_recording
from tests.report.flat_drive import make_drive


def export(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["export", *map(str, arguments)])


@pytest.fixture(scope="module", params=[("robot",), ("anna", "bert")])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten seconds through the flat."""
    drive = make_drive(tmp_path_factory.mktemp("drive"), speed_mps=0.8, robots=request.param)
    drive = replace(drive, ticks=drive.ticks[:100])
    drive.show_to(McapRecorder(McapRecorder.Options()))
    return drive.run.folder


def test_each_robot_gets_a_log_for_groot2_and_its_path_is_printed(run, tmp_path):
    shown = export(run, "--btlog", tmp_path / "first.btlog")
    assert shown.exit_code == 0, shown.output
    recording = read_recording(run / "recording.mcap")
    alone = len(recording.robots) == 1
    paths = {
        name: tmp_path / ("first.btlog" if alone else f"first-{name}.btlog") for name in recording.robots
    }
    assert shown.stdout.splitlines() == [str(path) for path in paths.values()]
    assert sorted(tmp_path.iterdir()) == sorted(paths.values())
    for name, path in paths.items():
        assert path.read_bytes() == btlog(recording, name)


def test_what_cannot_be_written_is_told_before_anything_is(run, tmp_path):
    for out, told in (("first.log", "write"), ("nowhere/first.btlog", "there is no folder")):
        shown = export(run, "--csv", tmp_path / "tables", "--btlog", tmp_path / out)
        assert shown.exit_code == 2
        assert told in shown.stderr
    assert not list(tmp_path.iterdir())


def test_an_export_to_nothing_names_every_option(run):
    shown = export(run)
    assert shown.exit_code == 2
    assert "--csv DIR, --parquet DIR, --video FILE.mp4 or --btlog FILE.btlog" in " ".join(
        shown.stderr.split()
    )

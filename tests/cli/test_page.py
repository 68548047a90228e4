"""The commands that show a page, as a person calls them: address, page, Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.cli.recordings import find_recording
from explore_bt.errors import UserError
from explore_bt.recording import McapRecorder, read_recording
from tests.cli.test_run import MISSION, WORLD
from tests.report.flat_drive import make_drive


@contextmanager
def started(*words: str, folder: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-u", "-c", "from explore_bt.cli import main; main()", *words]
    with subprocess.Popen(
        command,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # ignored below a shell's &
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def line_with(process: subprocess.Popen[str], words: str) -> str:
    assert process.stdout is not None
    heard = []
    for line in process.stdout:
        heard.append(line)
        if words in line:
            return line
    raise AssertionError(f"never said {words!r}: {''.join(heard)}")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("here") / "runs" / "flat"
    folder.mkdir(parents=True)
    make_drive(folder, speed_mps=2.0).show_to(McapRecorder(McapRecorder.Options()))
    return folder


def test_replay_shows_the_newest_run_until_ctrl_c(recorded):
    with started("replay", folder=recorded.parents[1]) as process:
        assert "runs/flat/recording.mcap: " in line_with(process, "mission time")
        url = line_with(process, "page").split()[-1]
        assert "explore-bt" in httpx.get(url).text
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0


def test_debug_runs_the_mission_keeps_the_page_and_ends_as_the_mission_did(tmp_path):
    (tmp_path / "box.yaml").write_text(textwrap.dedent(WORLD))
    (tmp_path / "mission.yaml").write_text(textwrap.dedent(MISSION))
    with started("debug", "mission.yaml", "--run-on", "--out", "out", folder=tmp_path) as process:
        url = line_with(process, "page").split()[-1]
        line_with(process, "the page stays to look at; Ctrl-C ends it")
        assert "explore-bt" in httpx.get(url).text
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
    assert read_recording(tmp_path / "out" / "recording.mcap").is_complete
    assert (tmp_path / "out" / "report.html").is_file()


def test_a_debugged_mission_that_is_stopped_before_its_first_tick_leaves_its_results(tmp_path):
    (tmp_path / "box.yaml").write_text(textwrap.dedent(WORLD))
    (tmp_path / "mission.yaml").write_text(textwrap.dedent(MISSION))
    with started("debug", "mission.yaml", "--out", "out", folder=tmp_path) as process:
        line_with(process, "getting ready")
        process.send_signal(signal.SIGINT)
        line_with(process, "stopped by hand (Ctrl-C)")
        line_with(process, "the page stays")
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
    assert (tmp_path / "out" / "result.json").is_file()


def test_a_recording_is_found_by_itself_by_its_folder_and_by_being_the_newest(recorded, monkeypatch):
    file = recorded / "recording.mcap"
    assert find_recording(recorded) == find_recording(file) == file
    monkeypatch.chdir(recorded.parents[1])
    other = Path("runs/earlier")
    other.mkdir()
    (other / "recording.mcap").write_bytes(b"")
    os.utime(other / "recording.mcap", (0, 0))
    assert find_recording(None) == Path("runs/flat/recording.mcap")


def test_a_run_that_is_not_there_is_told_in_one_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for run, words in (
        (None, "no recording in runs/"),
        (tmp_path, "holds no recording"),
        ("no", "there is no"),
    ):
        with pytest.raises(UserError, match=words):
            find_recording(run if run is None else Path(run))
    (tmp_path / "foreign.mcap").write_text("something else")
    shown = CliRunner().invoke(app, ["replay", "foreign.mcap"])
    assert shown.exit_code == 2
    assert "not an MCAP file" in shown.output
    assert "Traceback" not in shown.output

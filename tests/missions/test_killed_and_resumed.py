"""Real processes, real ``SIGKILL``; the longer version is benchmarks/resume.py."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from explore_bt.checkpoint import CheckpointStore
from explore_bt.recording import read_recording

_LOOK_S = 0.001


def start(*words: str, home: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", "from explore_bt.cli import main; main()", *words, "--headless"],
        cwd=home,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )


def kill_when(process: subprocess.Popen[bytes], is_time: Callable[[], bool]) -> None:
    while process.poll() is None and not is_time():
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_LOOK_S)
    assert process.poll() is None, process.communicate()[0].decode()
    process.send_signal(signal.SIGKILL)
    process.communicate()


def newest(run: Path) -> int:
    """Tick of the newest checkpoint."""
    return max((int(each.name) for each in run.glob("checkpoint/*") if each.name.isdecimal()), default=-1)


@pytest.mark.slow
def test_a_mission_killed_twice_comes_home_with_its_map(tmp_path: Path) -> None:
    run = tmp_path / "run"
    kill_when(start("run", "00_room", "--out", str(run), home=tmp_path), lambda: newest(run) >= 100)
    torn = lambda: newest(run) >= 200 and any(run.glob("checkpoint/.unfinished-*"))  # noqa: E731  # short
    kill_when(start("resume", str(run), home=tmp_path), torn)
    assert CheckpointStore(run / "checkpoint").newest()[1] == []  # what is half written is nothing
    last = start("resume", str(run), home=tmp_path)
    said = last.communicate()[0].decode()
    assert last.returncode == 0, said
    result = json.loads((run / "result.json").read_text())
    assert result["outcome"] == "explored"
    assert result["coverage"] > 0.99
    assert result["ate_rmse_m"] < 0.02
    assert result["contacts"] == 0
    recording = read_recording(run / "recording.mcap")
    assert recording.is_complete
    parts = [m for m in recording.messages("/events") if m.value["message"].startswith("part ")]
    assert len(parts) == 2

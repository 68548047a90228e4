"""A real outside client at a running mission: btview, as people start it."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from explore_bt.debug import AddBreakpoint, Breakpoint, Moment, Quit
from explore_bt.plugin import load_plugins
from tests.groot.conftest import Watched

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    """The furnished room, held where the robot has arrived for the second time."""
    run = Watched(
        ROOT / "missions/00_room.yaml", load_plugins().registry, tmp_path_factory.mktemp("run") / "room"
    )
    run.rest()
    run.session.submit(
        AddBreakpoint(Breakpoint("drive_to", Moment.AFTER, status="success", ignore=1))
    ).result(60)
    run.go_on()
    yield run
    run.session.submit(Quit())
    run.thread.join(120)


def btview(run: Watched, command: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "btview", command, "--port", str(run.port), "--timeout", "20", *arguments],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_snapshot_shows_the_tree_and_what_runs(room) -> None:
    shown = btview(room, "snapshot", "--ascii", "--no-color", "--ports", "--uid")
    for part in ("complete [ReactiveSequence]", "until nothing is left", "drive_to", "RUNNING", "SUCCESS"):
        assert part in shown, shown
    assert "until_seen" in shown


def test_blackboard_holds_what_the_robot_knows(room) -> None:
    boards = json.loads(btview(room, "blackboard", "--json"))
    assert boards["complete"].keys() >= {"goal", "visited", "half_planes"}
    assert boards["complete"]["goal"]["class"] == "Waypoint"


def test_a_session_is_recorded_and_a_tree_exported(room, tmp_path) -> None:
    out = tmp_path / "session.btv.jsonl"
    btview(room, "record", "--duration", "1", "-o", str(out))
    assert len(out.read_text().splitlines()) > 3
    xml = btview(room, "export", "--format", "xml")
    assert xml.count("drive_to") >= 4
    exported = json.loads(btview(room, "export", "--format", "json", "--with-status"))
    assert "RUNNING" in json.dumps(exported).upper()

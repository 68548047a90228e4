from __future__ import annotations

import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.cli.groot import groot_sinks
from explore_bt.debug import DebugSession
from explore_bt.errors import UserError
from explore_bt.groot.ends import Ends
from explore_bt.mission import Mission, load_mission
from explore_bt.plugin import load_plugins
from tests.groot.client import free_port

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def room() -> Mission:
    return load_mission(ROOT / "missions/00_room.yaml", load_plugins().registry)


def test_a_port_that_is_taken_is_told_before_anything_is_written(tmp_path: Path) -> None:
    port = free_port()
    ends = Ends("127.0.0.1", port)
    try:
        out = tmp_path / "run"
        words = ["run", "00_room", "--headless", "--groot", "--groot-port", str(port), "--out", str(out)]
        refused = CliRunner().invoke(app, words)
    finally:
        ends.close()
    assert refused.exit_code == 2
    assert f"the Groot2 server cannot have 127.0.0.1:{port}: address already in use" in refused.stderr
    assert not (out / "recording.mcap").exists()


def test_who_lets_others_in_is_warned(room: Mission, capsys: pytest.CaptureFixture[str]) -> None:
    port = free_port()
    for host, warned in (("127.0.0.1", False), ("0.0.0.0", True)):
        (sink,) = groot_sinks(True, room, DebugSession(), host, port)
        sink.close(None)
        told = capsys.readouterr()
        assert told.out == f"Groot2: robot robot at {host}:{port}\n"
        assert ("Groot2 knows no token" in told.err) == warned
    assert groot_sinks(False, room, DebugSession(), "127.0.0.1", port) == []


@pytest.mark.parametrize("missing", ["zmq", "msgpack"])
def test_a_missing_extra_says_what_to_type(
    missing: str, room: Mission, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith("explore_bt.groot")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(UserError, match=rf'needs {missing}; type pip install "explore-bt\[groot\]"'):
        groot_sinks(True, room, DebugSession(), "127.0.0.1", 1667)

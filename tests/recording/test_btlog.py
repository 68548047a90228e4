"""A recording as the log file that Groot2 plays: byte for byte as BehaviorTree.CPP lays it out."""

from __future__ import annotations

import struct
import time
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import behaviortreepy as bt
import pytest

from explore_bt.cli.btlog import write_btlogs
from explore_bt.errors import UserError
from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder, Recording, btlog, read_recording
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result
from tests.groot.box import MISSION, WORLD

NAMES = {0: "idle", 1: "running", 2: "success", 3: "failure"}


@dataclass(frozen=True)
class Log:
    xml: ElementTree.Element
    first_us: int
    transitions: list[tuple[int, int, int]]


def read_log(data: bytes) -> Log:
    """Written after BehaviorTree.CPP's logger, not after ours; refuses whatever is not exactly so."""
    magic = b"BTCPP4-FileLogger2"
    assert data[: len(magic)] == magic
    version, length = struct.unpack_from("<Bi", data, len(magic))
    assert version == 1
    at = len(magic) + 5
    xml = ElementTree.fromstring(data[at : at + length])
    (first_us,) = struct.unpack_from("<q", data, at + length)
    records = data[at + length + 8 :]
    assert len(records) % 9 == 0
    parts = [records[i : i + 9] for i in range(0, len(records), 9)]
    return Log(
        xml, first_us, [(int.from_bytes(p[:6], "little"), *struct.unpack("<HB", p[6:])) for p in parts]
    )


def numbered(xml: ElementTree.Element) -> dict[int, str]:
    return {int(each.get("_uid", "")): each.tag for each in xml.iter() if "_uid" in each.attrib}


def test_a_log_of_behaviortree_cpp_and_ours_have_one_layout(tmp_path: Path, run: Run) -> None:
    factory = bt.BehaviorTreeFactory()
    factory.register_simple_action("look", lambda *_: bt.NodeStatus.SUCCESS)
    tree = factory.create_tree_from_text(
        '<root BTCPP_format="4" main_tree_to_execute="main"><BehaviorTree ID="main"><Sequence><look/>'
        '<SubTree ID="rest"/></Sequence></BehaviorTree><BehaviorTree ID="rest"><look/></BehaviorTree></root>'
    )
    path = tmp_path / "theirs.btlog"
    logger = bt.FileLogger(tree, str(path))
    empty = path.stat().st_size
    tree.tick_exactly_once()
    give_up_s = time.monotonic() + 20.0
    while path.stat().st_size in (0, empty) and time.monotonic() < give_up_s:
        time.sleep(0.01)  # its writer has a thread of its own, and drops at the end what it has not written
    del logger
    for log in (read_log(path.read_bytes()), read_log(btlog(run.recording))):
        assert log.xml.get("BTCPP_format") == "4"
        assert sorted(numbered(log.xml)) == list(range(1, len(numbered(log.xml)) + 1))
        assert [tree.get("ID") for tree in log.xml.iter("BehaviorTree")] == ["main", "rest"]
        assert log.xml.find(".//SubTree").attrib.keys() == {"ID", "_fullpath", "_uid"}
        assert log.transitions
        assert {uid for _, uid, _ in log.transitions} <= numbered(log.xml).keys()
        assert {status for _, _, status in log.transitions} <= set(NAMES)


def test_played_back_it_shows_every_tick_as_it_was(run: Run) -> None:
    log = read_log(btlog(run.recording))
    assert log.first_us == 0
    left = list(log.transitions)
    shown = dict.fromkeys(sorted(numbered(log.xml)), "idle")
    for stamp_s, states in run.ticks:
        while left and left[0][0] <= round(stamp_s * 1e6):
            _, uid, status = left.pop(0)
            shown[uid] = NAMES[status]
        assert list(shown.values()) == list(states), f"at {stamp_s} s"
    assert not left
    assert len({states for _, states in run.ticks}) >= 5


def test_time_limits_and_attempts_are_told(run: Run) -> None:
    xml = read_log(btlog(run.recording)).xml
    assert xml.find(".//Timeout").get("msec") == "10000"
    assert xml.find(".//RetryUntilSuccessful").get("num_attempts") == "2"


def test_a_robot_that_is_not_there_is_named(run: Run) -> None:
    with pytest.raises(UserError, match='there is no robot "r2d2"; its robots: robot'):
        btlog(run.recording, "r2d2")


class Ticks(Sink):
    """What observers were shown, tick by tick."""

    name = "ticks"

    def __init__(self) -> None:
        super().__init__(PluginOptions())
        self.seen: list[tuple[float, tuple[str, ...]]] = []

    def open(self, run: RunInfo) -> None:
        pass

    def on_tick(self, tick: TickSnapshot) -> None:
        self.seen.append((tick.stamp_s, tuple(node.status for node in tick.robots[0].nodes)))

    def close(self, result: Result | None) -> None:
        pass


@dataclass(frozen=True)
class Run:
    recording: Recording
    ticks: list[tuple[float, tuple[str, ...]]]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("box")
    (folder / "box.yaml").write_text(WORLD)
    (folder / "mission.yaml").write_text(MISSION)
    registry, ticks = load_plugins().registry, Ticks()
    run_mission(
        load_mission(folder / "mission.yaml", registry),
        registry=registry,
        out=folder / "run",
        seed=0,
        sinks=[McapRecorder(McapRecorder.Options()), ticks],
        stop=StopFlag(),
    )
    return Run(read_recording(folder / "run/recording.mcap"), ticks.seen)


def test_a_file_is_written_whole_and_named_as_groot2_wants_it(run: Run, tmp_path: Path) -> None:
    assert write_btlogs(run.recording, tmp_path / "run.btlog") == [tmp_path / "run.btlog"]
    assert read_log((tmp_path / "run.btlog").read_bytes()).transitions
    with pytest.raises(UserError, match=r"does not end with \.btlog, as Groot2 wants it; write .*log\.btlog"):
        write_btlogs(run.recording, tmp_path / "log.bin")
    with pytest.raises(UserError, match="there is no folder"):
        write_btlogs(run.recording, tmp_path / "nowhere/run.btlog")

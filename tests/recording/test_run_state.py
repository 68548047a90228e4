from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from explore_bt.recording import McapRecorder, Recording, RobotState, Timeline, read_recording, state_at
from explore_bt.recording.run_state import FOLLOWED_TOPICS


@pytest.fixture(scope="module")
def recording(recorded_drive) -> Recording:
    return read_recording(recorded_drive.run.folder / "recording.mcap")


@pytest.fixture(scope="module")
def log(recording):
    return recording.log([topic for topic in recording.topics if not topic.endswith("/measured")])


class Slow:
    """The same from the first message on, one after the other."""

    def __init__(self) -> None:
        self.nodes, self.board, self.visited, self.newest = {}, {}, [], {}

    def take(self, part: str, value: dict) -> None:
        if part == "tree":
            self.nodes |= {node["id"]: (node["status"], node["message"]) for node in value["nodes"]}
        elif part == "blackboard":
            self.board |= value["set"]
            for name in value["removed"]:
                del self.board[name]
        elif part == "visited":
            self.visited = [*self.visited[: value["index"]], value]
        elif part in FOLLOWED_TOPICS:
            self.newest[part] = value

    @classmethod
    def at(cls, messages, end_s: float) -> Slow:
        slow = cls()
        for message in messages:
            if message.stamp_s <= end_s + 1e-6 and message.topic.startswith("/robot/"):
                slow.take(message.topic.removeprefix("/robot/"), message.value)
        return slow

    def __eq__(self, other: object) -> bool:
        assert isinstance(other, RobotState)
        nodes = {id_: (node.status, node.message) for id_, node in other.nodes.items()}
        newest = {name: message.value for name, message in other.newest.items()}
        return (nodes, dict(other.blackboard), list(other.visited), newest) == (
            self.nodes,
            self.board,
            self.visited,
            self.newest,
        )


@pytest.mark.parametrize("share", [0.0, 0.001, 0.13, 0.31, 0.499, 0.72, 0.9, 1.0])
def test_the_state_at_any_moment_is_what_all_messages_until_then_add_up_to(recording, log, share):
    at_ns = round(share * log.end_ns)
    same = Slow.at(recording.messages(), at_ns / 1e9) == state_at(log, "robot", at_ns)
    assert same  # not compared in the assertion: pytest would spell out a whole map


def test_a_state_told_in_messages_is_the_same_state(log):
    at_ns = log.end_ns // 3
    state, slow = state_at(log, "robot", at_ns), Slow()
    for message in state.messages("robot", at_ns):
        slow.take(message.topic.removeprefix("/robot/"), message.value)
    assert slow == state


def test_before_the_first_message_there_is_nothing(log):
    assert state_at(log, "robot", -1) == RobotState()
    assert state_at(log, "nobody", log.end_ns) == RobotState()


def test_a_rare_key_frame_is_found_however_far_back_it_is(recorded_drive, tmp_path):
    options = McapRecorder.Options(key_frame_period=1000)
    drive = replace(recorded_drive, ticks=recorded_drive.ticks[:900])
    drive.in_folder(tmp_path).show_to(McapRecorder(options))
    rare = read_recording(tmp_path / "recording.mcap")
    log = rare.log(rare.topics)
    at_ns = round(0.8 * log.end_ns)
    same = Slow.at(rare.messages(), at_ns / 1e9) == state_at(log, "robot", at_ns)
    assert same


def test_of_a_file_cut_off_the_state_is_known_to_its_end(recorded_drive, recording, tmp_path):
    data = (recorded_drive.run.folder / "recording.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[: len(data) // 2])
    cut = read_recording(tmp_path / "cut.mcap")
    log = cut.log(cut.topics)
    assert cut.damage
    assert log.end_ns > 100e9
    before_ns = log.end_ns - 1_000_000_000  # the last tick may be cut in two
    same = Slow.at(recording.messages(), before_ns / 1e9) == state_at(log, "robot", before_ns)
    assert same


def items_of(timeline: Timeline, kind: str) -> list[list]:
    return [item for item in map(json.loads, timeline.items) if item[0] == kind]


def test_the_timeline_tells_every_change_of_every_status(recording, log):
    timeline = Timeline(log, recording.robots)
    timeline.catch_up()
    told = {}
    for _, robot, stamp_s, id_, status, _ in items_of(timeline, "node"):
        told.setdefault((robot, id_), []).append((stamp_s, status))
    seen: dict[int, list] = {}
    for message in recording.messages("/robot/tree"):
        for node in message.value["nodes"]:
            lane = seen.setdefault(node["id"], [])
            if not lane or lane[-1][1] != node["status"]:
                lane.append((round(message.stamp_s, 3), node["status"]))
    changes = {
        id_: [each for i, each in enumerate(lane) if i == 0 or lane[i - 1][1] != each[1]]
        for (_, id_), lane in told.items()
    }
    assert changes == seen


def test_the_timeline_holds_the_way_the_curves_the_gate_and_the_words(recorded_drive, log):
    timeline = Timeline(log, ("robot",))
    timeline.catch_up()
    last = recorded_drive.ticks[-1].robots[0]
    *_, x, y, yaw_rad = items_of(timeline, "pose")[-1]
    pose = last.estimate.T_map_base
    assert (x, y) == pytest.approx((pose.x, pose.y), abs=1e-3)
    assert math.cos(yaw_rad - pose.yaw_rad) == pytest.approx(1.0, abs=1e-3)
    assert items_of(timeline, "figures")[-1][3] == pytest.approx(last.score.coverage, abs=1e-3)
    assert [item[3] for item in items_of(timeline, "gate")] == [True, False]
    assert len(items_of(timeline, "visited")) == len(last.blackboard["visited"])
    assert [item[5] for item in items_of(timeline, "event")] == [e.message for e in recorded_drive.events]
    assert [item[1] for item in items_of(timeline, "event")] == ["robot"] * len(recorded_drive.events)


def test_a_timeline_that_catches_up_again_and_again_is_the_same(recording, log):
    whole = Timeline(log, recording.robots)
    whole.catch_up()
    growing = type(log)()
    bit_by_bit = Timeline(growing, recording.robots)
    for index, message in enumerate(log.between(log.topics, -1, log.end_ns)):
        growing.add(message.topic, message.stamp_ns, message.text)
        if index % 997 == 0:
            bit_by_bit.catch_up()
    bit_by_bit.catch_up()
    assert bit_by_bit.items == whole.items

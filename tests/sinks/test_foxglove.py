"""A client that speaks Foxglove's WebSocket protocol looks on."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from explore_bt_sinks.foxglove import FoxgloveLive
from websockets.sync.client import ClientConnection, connect

from explore_bt.errors import PluginError
from explore_bt.recording import ROBOT_TOPICS, RUN_TOPICS, decode_grid
from tests.report.flat_drive import make_drive

_MESSAGE = struct.Struct("<BIQ")  # opcode 1, subscription, nanoseconds


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    return make_drive(tmp_path_factory.mktemp("drive"), speed_mps=0.8)


@pytest.fixture
def sink(drive) -> Iterator[FoxgloveLive]:
    sink = FoxgloveLive(FoxgloveLive.Options(port=0))
    sink.open(drive.run)
    yield sink
    sink.close(None)


class Viewer:
    """A client: what it was told of channels, and the messages of those it looks at."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.channels: dict[str, dict[str, object]] = {}
        self.info = json.loads(self.socket.recv(timeout=10))
        while len(self.channels) < len(RUN_TOPICS) + len(ROBOT_TOPICS) - 1:
            told = json.loads(self.socket.recv(timeout=10))
            assert told["op"] == "advertise"
            self.channels |= {channel["topic"]: channel for channel in told["channels"]}

    def look_at(self, *topics: str) -> None:
        wanted = [{"id": self.channels[t]["id"], "channelId": self.channels[t]["id"]} for t in topics]
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))

    def message(self) -> tuple[str, int, dict[str, object]]:
        """The next one: topic, nanoseconds, value."""
        data = self.socket.recv(timeout=10)
        assert isinstance(data, bytes)
        opcode, subscription, time_ns = _MESSAGE.unpack(data[: _MESSAGE.size])
        assert opcode == 1
        topic = next(t for t, channel in self.channels.items() if channel["id"] == subscription)
        return topic, time_ns, json.loads(data[_MESSAGE.size :])


@contextmanager
def looking(port: int) -> Iterator[Viewer]:
    address, protocols = f"ws://127.0.0.1:{port}", ["foxglove.sdk.v1"]
    with connect(address, subprotocols=protocols, max_size=None) as socket:
        yield Viewer(socket)


def test_all_topics_of_the_recording_are_offered_with_their_schemas_but_not_what_slam_was_given(sink):
    with looking(sink.port) as viewer:
        table = {topic.of("robot"): topic.schema for topic in (*RUN_TOPICS, *ROBOT_TOPICS)}
        del table["/robot/measured"]
        assert {name: channel["schemaName"] for name, channel in viewer.channels.items()} == table
        assert {channel["encoding"] for channel in viewer.channels.values()} == {"json"}
        assert json.loads(viewer.channels["/robot/map"]["schema"])["title"] == "foxglove.Grid"
        assert viewer.info["name"] == "01_apartment"


def test_who_looks_from_the_start_sees_every_tick(sink, drive):
    with looking(sink.port) as viewer:
        viewer.look_at("/run")
        topic, _, run = viewer.message()
        assert (topic, run["seed"]) == ("/run", drive.run.seed)
        viewer.look_at("/robot/pose", "/events")
        sink.on_event(drive.events[0])  # its arrival says that both are looked at
        assert viewer.message()[2]["message"] == drive.events[0].message
        for tick in drive.ticks[:20]:
            sink.on_tick(tick)
        poses = [viewer.message() for _ in range(20)]
        assert [time_ns for _, time_ns, _ in poses] == [
            round(tick.stamp_s * 1e9) for tick in drive.ticks[:20]
        ]
        last = drive.ticks[19].robots[0].estimate.T_map_base
        assert poses[-1][2]["pose"]["position"]["x"] == pytest.approx(last.x, abs=1e-4)


def test_who_comes_late_gets_the_newest_map(sink, drive):
    for tick in drive.ticks[:50]:
        sink.on_tick(tick)
    with looking(sink.port) as viewer:
        viewer.look_at("/robot/map")
        topic, _, value = viewer.message()
        assert topic == "/robot/map"
        grid = decode_grid(value)
        seen = [tick.robots[0].grid for tick in drive.ticks[:50]]
        shown = next(each for each in seen if each.revision == grid.revision)
        assert int(grid.free.sum()) == int(shown.free.sum()) > 100
        assert np.isclose(grid.resolution_m, shown.resolution_m)


def test_the_result_comes_before_it_hangs_up(drive):
    sink = FoxgloveLive(FoxgloveLive.Options(port=0))
    sink.open(drive.run)
    with looking(sink.port) as viewer:
        viewer.look_at("/run", "/result")
        assert viewer.message()[0] == "/run"
        sink.on_tick(drive.ticks[0])
        sink.close(drive.result)
        assert viewer.message()[2]["outcome"] == "explored"
        sink.close(drive.result)
        assert sink.port == 0


def test_a_port_that_is_taken_is_told_with_what_to_do(sink, drive):
    other = FoxgloveLive(FoxgloveLive.Options(port=sink.port))
    with pytest.raises(PluginError, match=f"cannot listen on 127.0.0.1:{sink.port}: .* option port"):
        other.open(drive.run)

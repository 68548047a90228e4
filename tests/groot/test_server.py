"""A client that speaks the protocol by hand: tree, status, blackboard, hooks, recordings, and nonsense."""

from __future__ import annotations

import itertools
import json
import random
import re
import socket
import struct
from xml.etree import ElementTree

import behaviortreepy as bt
import msgpack
import pytest
import zmq

from explore_bt.debug import Force, Resume
from explore_bt.errors import UserError
from explore_bt.groot.ends import Ends
from explore_bt.types import Outcome
from tests.groot.box import MISSION
from tests.groot.client import Client, RefusedError, free_port

IDLE, RUNNING, SUCCESS, FAILURE = 0, 1, 2, 3


def uids(client: Client) -> dict[str, int]:
    """Name in the tree -> number; the last of several."""
    root = ElementTree.fromstring(client.ask("T"))
    return {
        each.get("name", each.get("ID", "")): int(each.get("_uid", 0))
        for each in root.iter()
        if "_uid" in each.attrib
    }


def hook(
    uid: int, position: int = 0, mode: int = 0, answer: str = "SKIPPED", once: bool = False
) -> dict[str, object]:
    return {
        "enabled": True,
        "uid": uid,
        "mode": mode,
        "once": once,
        "desired_status": answer,
        "position": position,
    }


def unlock(uid: int, position: int = 0, answer: str = "SKIPPED", remove: bool = False) -> dict[str, object]:
    return {"uid": uid, "position": position, "desired_status": answer, "remove_when_done": remove}


def test_the_tree_is_told_with_its_numbers_ports_and_subtrees(watched, connect) -> None:
    client = connect(watched())
    root = ElementTree.fromstring(client.ask("T"))
    numbers = [int(each.get("_uid", 0)) for each in root.iter() if "_uid" in each.attrib]
    assert sorted(numbers) == list(range(1, len(client.statuses()) + 1))
    assert [tree.get("ID") for tree in root.iter("BehaviorTree")] == ["main", "rest"]
    assert "name" not in root.find(".//SubTree").attrib
    assert root.find(".//drive_to").get("goal") == "{goal}"
    assert root.find(".//Timeout").get("msec") == "10000"
    assert root.find(".//RetryUntilSuccessful").get("num_attempts") == "2"
    assert root.find(".//Repeat").get("num_cycles") == "2"
    assert root.find(".//Parallel").attrib.items() >= {"success_count": "1", "failure_count": "1"}.items()
    assert len(client.identities) == 1


def test_the_real_behaviortree_cpp_builds_the_tree_that_is_told(watched, connect) -> None:
    text = client_xml = connect(watched()).ask("T").decode()
    leaves = re.findall(r'<Action ID="(\w+)"', text)
    for port in ("duration", "goal", "x", "y"):  # its Python nodes have no ports
        client_xml = re.sub(rf'(<(?:{"|".join(leaves)}) [^>]*?) {port}="[^"]*"', r"\1", client_xml)
    factory = bt.BehaviorTreeFactory()
    for leaf in leaves:
        factory.register_simple_action(leaf, lambda *_: bt.NodeStatus.SUCCESS)
    factory.register_behavior_tree_from_text(client_xml)
    assert factory.create_tree("main").root_node().name() == "main"


def test_a_breakpoint_holds_the_run_is_told_once_and_answers_for_the_node(watched, connect) -> None:
    run = watched()
    client = connect(run)
    first = uids(client)["first"]
    client.ask("I", hook(first))
    for _ in range(200):  # until the subscription has come through, which nobody is told
        assert run.rest().paused
        run.go_on()
        if client.notices.poll(50):
            break
    head, uid = client.notices.recv_multipart()
    assert (head[:2], int(uid)) == (b"\x02N", first)
    state = run.rest()
    assert (state.path, state.moment) == ("main/first", "before")
    client.ask("U", unlock(first, answer="FAILURE"))
    assert run.rest().path == "main/first"  # the second attempt
    client.ask("U", unlock(first, answer="FAILURE", remove=True))
    assert json.loads(client.ask("D") if not run.rest().over else b"[]") == []
    assert run.result.result().outcome is Outcome.FAILED


def test_a_breakpoint_after_a_node_stops_there(watched, connect) -> None:
    run = watched()
    client = connect(run)
    place = uids(client)["choose_place"]
    client.ask("I", [hook(place, position=1, once=True)])
    state = run.go_on()
    assert (state.path, state.moment, state.status) == ("main/choose_place", "after", "success")
    assert client.statuses()[place] == SUCCESS
    with pytest.raises(RefusedError, match="has answered itself"):
        client.ask("U", unlock(place, position=1, answer="FAILURE"))
    assert msgpack.unpackb(client.ask("B", "main;rest;nobody")).keys() == {"main", "rest"}
    client.ask("U", unlock(place, position=1))
    assert run.result.result(60).outcome is Outcome.EXPLORED


def test_an_answer_is_injected_without_a_stop(watched, connect) -> None:
    run = watched()
    client = connect(run)
    client.ask("I", hook(uids(client)["drive_to"], mode=1, answer="FAILURE"))
    assert run.go_on().over
    assert run.result.result().outcome is Outcome.FAILED


def test_hooks_are_listed_replaced_disabled_and_removed(watched, connect) -> None:
    run = watched()
    client = connect(run)
    numbers = uids(client)
    first, place = numbers["first"], numbers["choose_place"]
    client.ask("I", [hook(first), hook(place, mode=1, answer="FAILURE")])
    client.ask("I", hook(place, once=True))
    dumped = {each["uid"]: each for each in json.loads(client.ask("D"))}
    assert dumped == {first: hook(first), place: hook(place, once=True)}
    assert run.session.state().forced == ()
    assert run.go_on().path == "main/first"
    client.ask("R", {"uid": first, "position": 0})  # which also lets the run go on
    assert run.rest().path == "main/choose_place"
    with pytest.raises(RefusedError, match="not found"):
        client.ask("R", {"uid": first, "position": 0})
    client.ask("I", hook(numbers["drive_to"]))
    client.ask("X")
    assert not run.session.state().breakpoints or not run.rest().paused or run.rest().path == ""
    assert run.result.result(60).outcome is Outcome.EXPLORED


def test_all_hooks_are_removed_at_once_and_forced_nodes_are_released(watched, connect) -> None:
    run = watched()
    client = connect(run)
    numbers = uids(client)
    client.ask("I", [hook(numbers["first"]), hook(numbers["drive_to"], mode=1, answer="FAILURE")])
    run.go_on()
    client.ask("A")
    assert run.rest().over
    assert run.result.result().outcome is Outcome.EXPLORED


def test_transitions_are_recorded_from_start_to_stop(watched, connect) -> None:
    run = watched()
    client = connect(run)
    numbers = uids(client)
    assert client.ask("t") == b""
    assert int(client.ask("r", "start")) > 1e15
    client.ask("I", hook(numbers["choose_place"]))
    run.go_on()
    client.ask("r", "stop")
    taken = client.ask("t")
    records = [
        (int.from_bytes(taken[i : i + 6], "little"), *struct.unpack("<HB", taken[i + 6 : i + 9]))
        for i in range(0, len(taken), 9)
    ]
    assert [status for _, uid, status in records if uid == numbers["first"]] == [RUNNING, SUCCESS]
    times = [time for time, _, _ in records]
    assert times == sorted(times)
    assert 1e6 < times[-1] < 60e6
    assert client.ask("t") == b""


def test_a_status_that_has_gone_idle_shows_what_it_was(watched, connect) -> None:
    run = watched()
    client = connect(run)
    numbers = uids(client)
    client.ask("I", hook(numbers["choose_place"]))
    run.go_on()
    waits = [uid for uid, _ in sorted(client.statuses().items())]
    assert client.statuses()[numbers["meet"]] == SUCCESS
    assert client.statuses()[numbers["drive_to"]] == IDLE
    assert 10 + RUNNING in (client.statuses()[uid] for uid in waits)  # halted at the parallel's threshold


NONSENSE = {
    "an empty message": [b""],
    "a short header": [b"\x02T\x00"],
    "a long header": [b"\x02T\x00\x00\x00\x00\x00"],
    "another protocol": [b"\x01T\x00\x00\x00\x00"],
    "a letter nobody knows": [b"\x02?\x00\x00\x00\x00"],
    "too many frames": [b"\x02T\x00\x00\x00\x00", b"", b""],
    "no second frame": [b"\x02I\x00\x00\x00\x00"],
    "no JSON": [b"\x02I\x00\x00\x00\x00", b"{"],
    "no text": [b"\x02B\x00\x00\x00\x00", b"\xff\xfe"],
    "deep JSON": [b"\x02I\x00\x00\x00\x00", b"[" * 100_000],
    "JSON of another kind": [b"\x02U\x00\x00\x00\x00", b"3"],
    "a hook without a node": [b"\x02I\x00\x00\x00\x00", b'{"position": 0, "mode": 0}'],
    "a hook on no node": [b"\x02I\x00\x00\x00\x00", b'{"uid": 999, "position": 0, "mode": 0}'],
    "a hook on a number that is none": [b"\x02I\x00\x00\x00\x00", b'{"uid": true, "position": 0, "mode": 0}'],
    "an answer after the fact": [b"\x02I\x00\x00\x00\x00", b'{"uid": 2, "position": 1, "mode": 1}'],
    "an answer that is none": [
        b"\x02I\x00\x00\x00\x00",
        b'{"uid": 2, "position": 0, "mode": 1, "desired_status": "RUNNING"}',
    ],
    "a recording that is neither begun nor ended": [b"\x02r\x00\x00\x00\x00", b"perhaps"],
}


def test_nonsense_is_answered_in_words_and_harms_nobody(watched, connect) -> None:
    run = watched()
    client = connect(run)
    for frames in NONSENSE.values():
        answer = client.raw(*frames)
        assert answer[0] == b"error", frames
        assert len(answer[1]) > 5
    noise = random.Random(0)
    for _ in range(200):
        frames = [noise.randbytes(noise.choice([0, 3, 6, 9])) for _ in range(noise.randint(1, 3))]
        assert client.raw(*frames)
    with socket.create_connection(("127.0.0.1", run.port)) as stranger:
        stranger.sendall(b"GET / HTTP/1.1\r\n\r\n" + noise.randbytes(10_000))
    with socket.create_connection(("127.0.0.1", run.port)) as half:
        half.sendall(b"\xff\x00\x00\x00\x00\x00\x00\x00\x01\x7f\x03")
    assert len(client.statuses()) > 10
    assert run.go_on().over
    assert run.result.result().outcome is Outcome.EXPLORED


def test_a_flood_and_clients_that_die_waiting_leave_the_run_as_it_is(watched, connect) -> None:
    run = watched()
    client = connect(run)
    for _ in range(20):
        dying = zmq.Context()
        asking = dying.socket(zmq.DEALER)
        asking.connect(f"tcp://127.0.0.1:{run.port}")
        for _ in range(100):
            asking.send_multipart([b"", b"\x02S\x00\x00\x00\x00"])
        dying.destroy(linger=0)
    assert len(client.statuses()) > 10
    assert run.go_on().over
    assert run.result.result().outcome is Outcome.EXPLORED


def test_a_client_that_has_gone_holds_nobody(watched, connect, caplog) -> None:
    run = watched(silent_client_s=1.0)
    client = connect(run)
    client.ask("I", hook(uids(client)["first"]))
    run.session.submit(Resume()).result(60)
    client.close()
    assert run.result.result(60).outcome is Outcome.EXPLORED
    assert "hooks are disabled" in caplog.text


def test_what_others_have_forced_stays_forced(watched, connect) -> None:
    run = watched()
    client = connect(run)
    run.session.submit(Force("drive_to", "failure")).result(60)
    client.ask("I", hook(uids(client)["choose_place"]))
    assert run.go_on().path == "main/choose_place"
    client.ask("A")
    assert run.result.result(60).outcome is Outcome.FAILED


def test_a_port_that_is_taken_is_named_before_anything_runs() -> None:
    port = free_port()
    ends = Ends("127.0.0.1", port)
    try:
        for taken in (port, port + 1, port - 1):
            with pytest.raises(UserError, match=r"cannot have 127.0.0.1:\d+: .*; give another --groot-port"):
                Ends("127.0.0.1", taken)
    finally:
        ends.close()


def test_each_robot_has_its_own_pair_of_ports_and_hooks(watched) -> None:
    stack = MISSION.split("  robot:\n", 1)[1].split("limits:", 1)[0]
    both = MISSION.replace("  robot:\n", f"  ann:\n{stack}  bob:\n", 1)
    both = both.replace("      - drive_to: {goal: $goal}\n", "")  # they cannot both stand in that place
    run = watched(both)
    assert run.sink.ports == {"ann": run.port, "bob": run.port + 2}
    clients = [Client(port) for port in run.sink.ports.values()]
    try:
        place = uids(clients[1])["choose_place"]
        clients[1].ask("I", hook(place))
        state = run.go_on()
        assert (state.robot, state.path) == ("bob", "main/choose_place")
        assert [json.loads(client.ask("D")) for client in clients] == [[], [hook(place)]]
        assert clients[0].identities.isdisjoint(clients[1].identities)
        clients[1].ask("A")
        assert run.result.result(60).outcome is Outcome.EXPLORED
    finally:
        for client in clients:
            client.close()


def test_status_is_that_of_the_moment_while_the_run_is_held(watched, connect) -> None:
    run = watched()
    client = connect(run)
    numbers = uids(client)
    client.ask("I", hook(numbers["first"], position=1))
    seen = []
    for _ in itertools.repeat(None, 3):
        state = run.go_on()
        seen.append((state.status, client.statuses()[numbers["first"]]))
    assert set(seen) == {("running", RUNNING)}

"""The contract of teams over Zenoh on loopback, and what is special to a network."""

import itertools
import random
import socket
from contextlib import ExitStack

import pytest
from explore_bt_teams import LocalTeam, ZenohOptions, ZenohTeam
from explore_bt_teams.inbox import Inbox
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from explore_bt.clock import WallClock
from explore_bt.errors import PluginError
from explore_bt.interfaces import Commons, Letter, RobotContext, Team
from explore_bt.testing import TeamContract

zenoh = pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed")
FLEETS = itertools.count()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class TestZenohTeam(TeamContract):
    """Each listens at a port of its own and goes to those before it; nothing leaves this machine."""

    settle_s = 0.3

    @pytest.fixture(autouse=True)
    def fleet(self) -> None:
        self.name, self.endpoints = f"fleet{next(FLEETS)}", ()

    def make(self) -> Team:
        own = f"tcp/127.0.0.1:{free_port()}"
        options = ZenohOptions(fleet=self.name, listen=(own,), connect=self.endpoints, multicast=False)
        self.endpoints = (*self.endpoints, own)
        return ZenohTeam(options)


def heard(team: ZenohTeam, patience_s: float = 20.0) -> list[Letter]:
    """The first news."""
    clock = WallClock()
    while clock.now_s() < patience_s:
        if letters := list(team.hear()):
            return letters
        clock.wait_until(clock.now_s() + 0.02)
    return []


def test_clients_hear_one_another_through_a_router_and_again_once_it_has_come_back() -> None:
    """What was said while there was none is not lost: the newest of every topic counts."""
    endpoint, commons = f"tcp/127.0.0.1:{free_port()}", Commons()
    options = ZenohOptions(fleet=f"fleet{next(FLEETS)}", mode="client", connect=(endpoint,), multicast=False)
    ada, bob = ZenohTeam(options), ZenohTeam(options)
    with ExitStack() as ending:
        for team in (ada, bob):
            ending.callback(team.close)
        with ZenohTeam.router([endpoint]):
            ada.setup(RobotContext(robot="ada", commons=commons))
            bob.setup(RobotContext(robot="bob", commons=commons))
            ada.say("presence", b"here")
            assert heard(bob) == [Letter("ada", "presence", b"here")]
        ada.say("tile/0/0", b"said to nobody")
        with ZenohTeam.router([endpoint]):
            found: dict[str, bytes] = {}
            clock = WallClock()
            while len(found) < 2 and clock.now_s() < 30.0:
                ada.say("presence", b"still here")
                found |= {letter.topic: letter.payload for letter in bob.hear()}
                clock.wait_until(clock.now_s() + 0.1)
    assert found == {"presence": b"still here", "tile/0/0": b"said to nobody"}


def test_udp_is_refused_for_it_loses_who_wants_to_hear_whom() -> None:
    with pytest.raises(ValidationError, match=r"a robot stays deaf; write tcp/127.0.0.1:7447"):
        ZenohOptions(listen=("udp/127.0.0.1:7447",))


def test_nobody_is_asked_for_words_that_are_said_often_and_an_old_one_does_not_come_late() -> None:
    inbox = Inbox()
    for number in (1, 5, 3):
        inbox.put(Letter("a", "presence", b"%d" % number), 1, number, is_counted=False)
    inbox.put(Letter("a", "tile/0/0", b"first"), 1, 1)
    assert {letter.payload for letter in inbox.drain()} == {b"5", b"first"}
    assert inbox.missing(10.0) == []


def test_a_team_of_one_process_has_no_router() -> None:
    with pytest.raises(PluginError, match="team local has no router"):
        LocalTeam.router([])


def test_an_endpoint_that_cannot_be_had_is_named() -> None:
    team = ZenohTeam(ZenohOptions(listen=("tcp/192.0.2.1:1",), multicast=False))
    with pytest.raises(PluginError, match=r"team zenoh: no session: .* Check connect, listen and multicast"):
        team.setup(RobotContext(robot="a", commons=Commons()))


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 100_000), lost=st.floats(0.0, 0.9), cut=st.integers(0, 60))
def test_whatever_is_dropped_delayed_or_repeated_the_newest_of_all_topics_comes_in_the_end(
    seed: int, lost: float, cut: int
) -> None:
    """Also the answers, whole or in part, are lost for a while; then the network is well again."""
    chance = random.Random(seed)
    inbox, said, heard = Inbox(), {}, {}
    under_way: list[tuple[str, int]] = []

    def deliver(topic: str, number: int) -> None:
        inbox.put(Letter("a", topic, b"%d" % number), 1, number)

    for step in range(1, 121):
        topic = f"tile/{chance.randrange(8)}" if step < 100 else "presence"
        said[topic] = step
        is_well = step > 100
        if is_well or (step > cut and chance.random() > lost):
            under_way.append((topic, step))
        chance.shuffle(under_way)
        while under_way and (is_well or chance.random() < 0.7):
            word = under_way.pop()
            deliver(*word)
            if chance.random() < 0.2:
                deliver(*word)
        for name, since in inbox.missing(float(step)):
            assert name == "a"
            if is_well or chance.random() > lost:
                told = {number: asked for asked, number in said.items() if number > since}
                for number, asked in told.items():
                    if is_well or chance.random() > lost:
                        deliver(asked, number)
                inbox.answered("a", 1, step, told)
        for letter in inbox.drain():
            number = int(letter.payload)
            assert number > heard.get(letter.topic, 0), "nothing twice, nothing late"
            heard[letter.topic] = number
    assert heard == said


def test_who_comes_back_begins_anew_and_words_of_its_life_before_are_not_heard() -> None:
    inbox = Inbox()
    inbox.put(Letter("a", "presence", b"old"), 1, 7)
    inbox.put(Letter("a", "presence", b"new"), 2, 1)
    inbox.put(Letter("a", "tile/0/0", b"ghost"), 1, 8)
    assert [letter.payload for letter in inbox.drain()] == [b"new"]
    assert inbox.missing(10.0) == []

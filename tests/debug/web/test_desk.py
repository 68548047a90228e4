from __future__ import annotations

import asyncio
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from explore_bt.debug.web import Desk, LiveSink
from explore_bt.debug.web.client import Share
from explore_bt.debug.web.controls import read_command
from explore_bt.debug.web.requests import AskCommand, AskFollow, AskRun, AskState, AskTimeline, read_request
from explore_bt.errors import DebugError
from explore_bt.recording import state_at


def answered(desk: Desk, request) -> dict:
    return json.loads(f"{{{desk.answer(request)}}}")


@pytest.fixture
def desk(feed) -> Desk:
    return Desk(feed)


def test_the_run_is_told_as_it_was_recorded(desk, recording):
    told = answered(desk, AskRun(id=1, ask="run"))
    assert told["run"] == recording.info
    assert told["end_s"] == pytest.approx(recording.duration_s)
    assert told["damage"] == ""


def test_a_state_holds_the_messages_of_the_recording_at_that_time(desk, feed):
    told = answered(desk, AskState(id=1, ask="state", at_s=40.0))
    assert told["at_s"] == 40.0
    latest = {topic: value for topic, _, value in told["messages"]}
    for robot in feed.robots:
        expected = state_at(feed.log, robot, 40_000_000_000)
        assert latest[f"/{robot}/map"] == expected.newest["map"].value
        assert latest[f"/{robot}/blackboard"]["set"] == expected.blackboard
        assert [n["status"] for n in latest[f"/{robot}/tree"]["nodes"]] == [
            node.status for node in expected.nodes.values()
        ]


def test_a_state_outside_the_run_is_that_of_its_nearest_end(desk, recording):
    told = answered(desk, AskState(id=1, ask="state", at_s=1e9))
    assert told["at_s"] == pytest.approx(recording.duration_s)


def test_following_from_state_to_state_misses_nothing_and_tells_nothing_twice(desk, feed):
    told = []
    time_s = 10.0
    while time_s < 30.0:
        answer = answered(desk, AskFollow(id=1, ask="follow", after_s=time_s, until_s=time_s + 0.7))
        assert not answer["fresh"]
        told += [(topic, stamp_s) for topic, stamp_s, _ in answer["messages"]]
        time_s = answer["at_s"]
    expected = feed.between(10_000_000_000, round(time_s * 1e9))
    assert told == [(message.topic, message.stamp_ns / 1e9) for message in expected]


def test_who_is_far_behind_gets_where_things_are_not_all_that_came_between(desk):
    answer = answered(desk, AskFollow(id=1, ask="follow", after_s=5.0, until_s=70.0))
    assert answer["fresh"]
    assert answer == answered(desk, AskState(id=1, ask="state", at_s=70.0))


def test_the_timeline_comes_in_pieces_and_whole(desk, feed):
    items = []
    while True:
        answer = answered(desk, AskTimeline(id=1, ask="timeline", begin=len(items)))
        items += answer["items"]
        assert answer["next"] == len(items)
        if not answer["more"]:
            break
    assert items == [json.loads(item) for item in feed.timeline.items]
    assert answered(desk, AskTimeline(id=1, ask="timeline", begin=10**9))["items"] == []


def test_a_recording_cannot_be_commanded(desk):
    with pytest.raises(DebugError, match="recording"):
        asyncio.run(desk.have_done(AskCommand(id=1, ask="command", command={"do": "Pause"})))


@given(
    st.one_of(
        st.text(max_size=50),
        st.recursive(
            st.none() | st.booleans() | st.floats() | st.text(max_size=5),
            lambda inside: (
                st.lists(inside, max_size=3) | st.dictionaries(st.text(max_size=5), inside, max_size=3)
            ),
        ).map(json.dumps),
    )
)
def test_whatever_is_not_a_request_is_refused(text):
    with pytest.raises(ValidationError):
        read_request(text)


@pytest.mark.parametrize(
    "text",
    [
        *('{"id":1,"ask":"state","at_s":1e999}', '{"id":1,"ask":"state","at_s":-1}'),
        *('{"id":1,"ask":"state"}', '{"id":1,"ask":"state","at_s":1,"more":1}', '{"ask":"run"}'),
        *('{"id":-1,"ask":"run"}', '{"id":1,"ask":"delete"}', '{"id":1,"ask":"state","at_s":null}'),
        *("[" * 20_000, '{"id":1e99,"ask":"run"}', '{"id":1,"ask":"look","robot":"' + "x" * 300 + '"}'),
    ],
)
def test_requests_that_are_nearly_right_are_refused(text):
    with pytest.raises(ValidationError):
        read_request(text)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({}, "no such command"),
        ({"do": "Look"}, "no such command"),
        ({"do": ["Pause"]}, "no such command"),
        ({"do": "Pause", "now": 1}, "takes no now"),
        ({"do": "Step", "kind": "mile"}, "Step: kind"),
        ({"do": "Step", "count": "many"}, "Step: count"),
        ({"do": "AddBreakpoint", "breakpoint": {"moment": "after"}}, "AddBreakpoint: breakpoint.path"),
        ({"do": "Force", "path": "x"}, "Force: status"),
    ],
)
def test_a_command_that_is_none_is_refused_in_words(told, words):
    with pytest.raises(DebugError, match=words):
        read_command(told)


def test_live_and_from_the_file_the_page_gets_the_same_messages(drive, feed):
    live = LiveSink()
    drive.show_to(live)
    of_the_file = feed.log.between(feed.log.topics, -1, feed.log.end_ns)
    of_the_run = live.feed.log.between(feed.log.topics, -1, feed.log.end_ns)
    for ours, theirs in zip(of_the_run, of_the_file, strict=True):
        assert ours == theirs
    assert json.loads(live.feed.run_text) == json.loads(feed.run_text)
    assert not any(topic.endswith("/measured") for topic in live.feed.log.topics)


def test_a_run_that_goes_on_is_told_only_up_to_its_last_whole_tick(drive):
    live = LiveSink()
    desk = Desk(live.feed)
    assert json.loads(desk.news()) == {"end_s": 0.0, "ready": False, "live": False}
    assert answered(desk, AskRun(id=1, ask="run"))["run"] is None
    live.open(drive.run)
    for tick in drive.ticks[:50]:
        live.on_tick(tick)
    live.feed.log.add("/anna/gate", round(4.95e9), '{"braking":true,"reason":"half a tick"}')
    news = json.loads(desk.news())
    assert news["ready"]
    assert news["end_s"] == pytest.approx(drive.ticks[49].stamp_s)
    answer = answered(desk, AskFollow(id=1, ask="follow", after_s=4.5, until_s=1e9))
    assert answer["at_s"] == news["end_s"]
    assert "half a tick" not in str(answer["messages"])
    live.close(None)


@given(st.lists(st.floats(0.001, 2.0), min_size=1, max_size=20), st.floats(0.05, 1.0))
def test_all_answers_together_stay_below_their_share_of_the_time(works_s, share):
    now_s = 0.0

    async def sleep(seconds: float) -> None:
        nonlocal now_s
        now_s += seconds

    def work(spent_s: float) -> str:
        nonlocal now_s
        now_s += spent_s
        return f"worked {spent_s}"

    async def spend() -> list[str]:
        shared = Share(share, lambda: now_s, sleep)
        every = [shared.spend(lambda spent_s=spent_s: work(spent_s)) for spent_s in works_s]
        return await asyncio.gather(*every, shared.spend(lambda: ""))

    assert asyncio.run(spend()) == [*(f"worked {spent_s}" for spent_s in works_s), ""]
    assert sum(works_s) <= share * now_s * (1 + 1e-9)

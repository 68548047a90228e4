from __future__ import annotations

import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.recording import LoggedMessage, MessageLog

TOPICS = ("/a", "/b", "/ü/c")

messages = st.lists(
    st.tuples(st.sampled_from(TOPICS), st.integers(0, 3), st.text(max_size=20)), max_size=60
).map(
    lambda drawn: [
        LoggedMessage(topic, sum(step for _, step, _ in drawn[: index + 1]), text)
        for index, (topic, _, text) in enumerate(drawn)
    ]
)


def filled(told: list[LoggedMessage], **options) -> MessageLog:
    log = MessageLog(**options)
    for message in told:
        log.add(message.topic, message.stamp_ns, message.text)
    return log


@settings(deadline=None)
@given(told=messages, chunk_ns=st.integers(1, 30), first=st.integers(-1, 200), last=st.integers(-1, 200))
def test_whatever_the_chunks_it_finds_what_a_plain_list_finds(told, chunk_ns, first, last):
    log = filled(told, chunk_ns=chunk_ns)
    assert len(log) == len(told)
    assert log.topics == tuple(dict.fromkeys(message.topic for message in told))
    for topic in TOPICS:
        until = [message for message in told if message.topic == topic and message.stamp_ns <= last]
        assert log.last(topic, last) == (until[-1] if until else None)
    expected = [m for m in told if m.topic in TOPICS[:2] and first < m.stamp_ns <= last]
    assert list(log.between(TOPICS[:2], first, last)) == expected


@settings(deadline=None)
@given(told=messages, most=st.integers(1, 7))
def test_reading_on_from_count_to_count_gives_every_message_once_in_its_order(told, most):
    log = filled(told, chunk_ns=5)
    read: list[LoggedMessage] = []
    count = 0
    while count < len(log):
        some, count = log.after(TOPICS[:2], count, most)
        assert len(some) <= most
        read += some
    assert read == [message for message in told if message.topic in TOPICS[:2]]
    assert log.after(TOPICS[:2], count, most) == ([], count)


@settings(deadline=None)
@given(told=messages, limit=st.integers(20, 200))
def test_within_its_limit_it_keeps_the_newest_and_the_last_of_each_topic(told, limit):
    log = filled(told, chunk_ns=4, limit_bytes=limit)
    kept = list(log.between(TOPICS, -1, 10**9))
    assert kept == told[len(told) - len(kept) :]
    for topic in TOPICS:
        of_topic = [message for message in told if message.topic == topic]
        assert log.last(topic, 10**9) == (of_topic[-1] if of_topic else None)
    if len(kept) < len(told):
        assert log.begin_ns == told[len(told) - len(kept) - 1].stamp_ns


def test_what_is_given_up_gives_its_memory_back():
    log = MessageLog(chunk_ns=10, limit_bytes=20_000)
    text = "".join(chr(0x4E00 + (k * k) % 20000) for k in range(500))
    for stamp_ns in range(5_000):
        log.add("/a", stamp_ns, f"{stamp_ns} {text[stamp_ns % 400 :]}")
    left = list(log.between(["/a"], -1, 5_000))
    assert 10 <= len(left) < 1_000
    assert left[-1].stamp_ns == 4_999


def test_a_lone_surrogate_is_kept_as_the_recorder_keeps_it():
    log = filled([LoggedMessage("/a", 0, '{"x":"\ud800"}')])
    found = log.last("/a", 0)
    assert found is not None
    assert found.text == '{"x":"\\ud800"}'


def test_readers_in_other_threads_never_see_a_message_torn_or_out_of_order():
    log = MessageLog(chunk_ns=7, limit_bytes=30_000)
    stop = threading.Event()
    faults: list[str] = []

    def read() -> None:
        while not stop.is_set():
            last = log.last("/a", 10**9)
            if last is not None and last.text != f"message {last.stamp_ns}":
                faults.append(last.text)
            some = [m.stamp_ns for m in log.between(["/a", "/b"], log.end_ns - 50, 10**9)]
            if some != sorted(some):
                faults.append(str(some))

    readers = [threading.Thread(target=read) for _ in range(3)]
    for reader in readers:
        reader.start()
    for stamp_ns in range(20_000):
        log.add("/a" if stamp_ns % 2 else "/b", stamp_ns, f"message {stamp_ns}")
    stop.set()
    for reader in readers:
        reader.join()
    assert faults == []


def test_it_says_how_far_it_reaches():
    log = filled([LoggedMessage("/a", 5, "x"), LoggedMessage("/b", 9, "y")])
    assert (log.begin_ns, log.end_ns) == (0, 9)
    assert log.last("/nobody", 9) is None
    assert log.last("/b", 8) is None


@pytest.mark.parametrize("at_ns", [5, 6])
def test_of_messages_at_one_moment_the_last_counts(at_ns):
    log = filled([LoggedMessage("/a", 5, "x"), LoggedMessage("/a", 5, "y")])
    found = log.last("/a", at_ns)
    assert found is not None
    assert found.text == "y"


def test_what_a_state_needs_all_of_is_kept_whatever_the_limit():
    log = MessageLog(chunk_ns=3, limit_bytes=100, at_hand=("/b",))
    told = [LoggedMessage("/a" if k % 5 else "/b", k, f"{k} {k * k}") for k in range(500)]
    for message in told:
        log.add(message.topic, message.stamp_ns, message.text)
    assert list(log.between(["/b"], -1, 500)) == [message for message in told if message.topic == "/b"]
    assert len(list(log.between(["/a"], -1, 500))) < 300
    count, read = 0, []
    while count < len(log):
        some, count = log.after(["/b"], count, 7)
        read += some
    assert read == [message for message in told if message.topic == "/b"]

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap.writer import Writer

from explore_bt.errors import UserError
from explore_bt.recording import McapRecorder, RecordingError, read_recording


@pytest.fixture(scope="module")
def whole(recorded_drive, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cut")
    drive = replace(recorded_drive, ticks=recorded_drive.ticks[:150]).in_folder(folder)
    drive.show_to(McapRecorder(McapRecorder.Options()))
    return folder / "recording.mcap"


def chunk_ends(path):
    """Where each chunk ends in the file, found by the library's own reader."""
    with path.open("rb") as file:
        return [
            (file.tell(), record.message_end_time * 1e-9)
            for record in StreamReader(file, emit_chunks=True).records
            if isinstance(record, Chunk)
        ]


@settings(deadline=None, max_examples=80)
@given(share=st.floats(0.0, 0.9999))
def test_a_file_cut_anywhere_gives_every_closed_chunk(whole, share):
    data = whole.read_bytes()
    length = int(len(data) * share)
    cut = whole.with_name("cut.mcap")
    cut.write_bytes(data[:length])
    closed = [end_s for end, end_s in chunk_ends(whole) if end <= length]
    if not closed:
        with pytest.raises(RecordingError):
            read_recording(cut)
        return
    recording = read_recording(cut)
    assert recording.duration_s == pytest.approx(max(closed))
    assert not recording.is_complete
    told = re.match(r"cut off after byte (\d+): ", recording.damage)
    assert told
    assert max(end for end, _ in chunk_ends(whole) if end <= length) <= int(told[1]) <= length
    assert recording.info["seed"] == 3
    last = max((m.stamp_s for m in recording.messages("/robot/pose")), default=0.0)
    assert last == pytest.approx(max(closed), abs=0.11)


@settings(deadline=None, max_examples=60)
@given(share=st.floats(0.1, 0.95), byte=st.integers(0, 255))
def test_a_damaged_byte_costs_at_most_what_follows_and_never_an_exception(whole, share, byte):
    data = bytearray(whole.read_bytes())
    data[int(len(data) * share)] ^= byte
    damaged = whole.with_name("damaged.mcap")
    damaged.write_bytes(data)
    recording = read_recording(damaged)
    assert all(isinstance(message.value, dict) for message in recording.messages())


def refusal(path):
    with pytest.raises(UserError) as caught:
        read_recording(path)
    return str(caught.value)


def test_a_file_of_another_kind_is_refused(tmp_path):
    path = tmp_path / "photo.jpg"
    path.write_bytes(b"\xff\xd8\xff\xe0 and so on")
    assert refusal(path) == f"{path}: not an MCAP file; expected a recording.mcap written by explore-bt run"


def test_an_empty_file_is_refused(tmp_path):
    path = tmp_path / "recording.mcap"
    path.touch()
    assert refusal(path) == f"{path}: an empty file; expected a recording.mcap written by explore-bt run"


def test_a_missing_file_is_refused(tmp_path):
    path = tmp_path / "recording.mcap"
    assert refusal(path) == f"{path}: cannot be read: No such file or directory; give a recording.mcap"


def test_a_folder_is_refused(tmp_path):
    assert refusal(tmp_path) == f"{tmp_path}: cannot be read: Is a directory; give a recording.mcap"


def test_a_recording_of_another_program_is_refused_and_named(tmp_path):
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2", library="rosbag2")
        writer.finish()
    assert refusal(path) == (
        f"{path}: an MCAP file of profile 'ros2' by 'rosbag2'; "
        "expected a recording.mcap written by explore-bt run ('x-explore-bt')"
    )


def test_a_file_cut_before_the_first_chunk_is_refused(whole, tmp_path):
    path = tmp_path / "recording.mcap"
    path.write_bytes(whole.read_bytes()[:60])
    found = re.sub(r"byte \d+", "byte N", refusal(path).removeprefix(f"{path}: "))
    assert found == "cut off after byte N, before its first second was written; nothing can be recovered"


def test_the_damage_is_told_in_words(whole, tmp_path):
    path = tmp_path / "recording.mcap"
    end, end_s = chunk_ends(whole)[8]
    path.write_bytes(whole.read_bytes()[: end + 40])
    damage = read_recording(path).damage
    told = re.fullmatch(r"cut off after byte (\d+): ends at (\d+\.\d) s of mission time", damage)
    assert told
    assert end <= int(told[1]) < end + 40
    assert float(told[2]) == pytest.approx(end_s, abs=0.06)

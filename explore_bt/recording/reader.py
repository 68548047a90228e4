"""Reads a recording, whole or cut off in the middle."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import zstandard
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, Header, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from explore_bt.errors import LogError
from explore_bt.recording.message_log import MessageLog
from explore_bt.recording.topics import PROFILE

__all__ = ["RecordedMessage", "Recording", "RecordingError", "read_recording"]

_MAGIC = b"\x89MCAP0\r\n"
_BROKEN = (
    McapError,
    struct.error,
    zstandard.ZstdError,
    zlib.error,
    ValueError,
    EOFError,
    OverflowError,  # a damaged length
    MemoryError,  # the same
)


class RecordingError(LogError):
    """A file that is not a recording of ours, or holds not even its first chunk."""


@dataclass(frozen=True, slots=True)
class RecordedMessage:
    """A message as it was written: ``value`` is what its JSON says."""

    topic: str
    stamp_s: float
    value: dict[str, Any]


class Recording:
    """What can be read of a run.

    Attributes:
        path: the file.
        topics: all topics of the file, in the order they were declared.
        schemas: topic -> name of its schema.
        info: the message on ``/run``.
        damage: empty for a whole file, else in words what is missing.
    """

    def __init__(self, path: Path, contents: _Contents) -> None:
        self.path = path
        self.damage = contents.damage
        self._chunks = contents.chunks
        self._channels = {number: channel.topic for number, channel in contents.channels.items()}
        self.topics = tuple(self._channels.values())
        self.schemas = {
            channel.topic: contents.schemas.get(channel.schema_id, "")
            for channel in contents.channels.values()
        }
        self.info = next((message.value for message in self.messages("/run")), {})

    @property
    def is_complete(self) -> bool:
        """Whether the file was closed as it should be."""
        return not self.damage

    @property
    def duration_s(self) -> float:
        """Mission time of the last message, seconds."""
        return max((chunk.message_end_time for chunk in self._chunks), default=0) * 1e-9

    @property
    def robots(self) -> tuple[str, ...]:
        """Names of the robots."""
        return tuple(self.info.get("trees", {}))

    def messages(
        self, topic: str | Collection[str] | None = None, start_s: float = 0.0, end_s: float = float("inf")
    ) -> Iterator[RecordedMessage]:
        """Messages of one topic, of several, or of all (None), in file order.

        Args:
            topic: which.
            start_s: the first stamp that counts, mission time.
            end_s: the last one.
        """
        wanted = {topic} if isinstance(topic, str) else topic
        for name, time_ns, data in self._raw(start_s, end_s):
            stamp_s = time_ns * 1e-9
            if (wanted is None or name in wanted) and start_s <= stamp_s <= end_s:
                yield RecordedMessage(name, stamp_s, json.loads(data))

    def last(self, topic: str, start_s: float = 0.0) -> RecordedMessage | None:
        """The last message of a topic; None where there is none since ``start_s``."""
        newest = None
        for newest in self.messages(topic, start_s):  # noqa: B007  # only the last one counts
            pass
        return newest

    def raw_messages(self) -> Iterator[tuple[str, int, bytes]]:
        """Topic, mission time in nanoseconds and bytes of every message, in file order."""
        return self._raw(0.0, float("inf"))

    def _raw(self, start_s: float, end_s: float) -> Iterator[tuple[str, int, bytes]]:
        """Of the chunks that reach into a span of time."""
        for chunk in self._chunks:
            if chunk.message_end_time * 1e-9 < start_s or chunk.message_start_time * 1e-9 > end_s:
                continue
            for record in breakup_chunk(chunk):
                if isinstance(record, Message) and record.channel_id in self._channels:
                    # else declared in a chunk that was lost
                    yield self._channels[record.channel_id], record.log_time, record.data

    def log(self, topics: Collection[str]) -> MessageLog:
        """The messages of these topics, to be found by time again and again."""
        log = MessageLog()
        for name, time_ns, data in self.raw_messages():
            if name in topics:
                log.add(name, time_ns, data.decode())
        return log


def read_recording(path: Path) -> Recording:
    """Open a recording, also one whose writer was killed.

    Of a cut file every closed chunk is read; ``damage`` then says where it ends.

    Raises:
        RecordingError: no such file, a foreign file, or one cut before its first chunk ended.
    """
    try:
        size = path.stat().st_size
        file = path.open("rb")
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror}; give a recording.mcap") from None
    with file:
        if file.read(len(_MAGIC)) != _MAGIC:
            found = "an empty file" if size == 0 else "not an MCAP file"
            raise RecordingError(f"{path}: {found}; expected a recording.mcap written by explore-bt run")
        file.seek(0)
        contents = _read_contents(path, file, size)
    if not contents.chunks:
        raise RecordingError(
            f"{path}: cut off after byte {contents.sound_bytes}, before its first second was written; "
            "nothing can be recovered"
        )
    return Recording(path, contents)


@dataclass(slots=True)
class _Contents:
    """The sound chunks of a file, its channels, and what is wrong with it."""

    chunks: list[Chunk] = field(default_factory=list)
    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, str] = field(default_factory=dict)
    unsound: list[int] = field(default_factory=list)
    sound_bytes: int = 0
    whole: bool = False

    def take(self, chunk: Chunk) -> None:
        try:
            records = breakup_chunk(chunk, validate_crc=True)
        except _BROKEN:
            self.unsound.append(self.sound_bytes)
            return
        self.chunks.append(chunk)
        self.channels |= {record.id: record for record in records if isinstance(record, Channel)}
        self.schemas |= {record.id: record.name for record in records if isinstance(record, Schema)}

    @property
    def damage(self) -> str:
        end_s = max(chunk.message_end_time for chunk in self.chunks) * 1e-9
        cut = (
            ""
            if self.whole
            else f"cut off after byte {self.sound_bytes}: ends at {end_s:.1f} s of mission time"
        )
        places = ", ".join(map(str, self.unsound))
        lost = f"unsound chunks left out, from byte {places}" if self.unsound else ""
        return "; ".join(part for part in (cut, lost) if part)


def _read_contents(path: Path, file: BinaryIO, size: int) -> _Contents:
    contents = _Contents()
    reader = StreamReader(file, emit_chunks=True, record_size_limit=size)
    try:
        for record in reader.records:
            if isinstance(record, Header) and record.profile != PROFILE:
                raise RecordingError(
                    f"{path}: an MCAP file of profile {record.profile!r} by {record.library!r}; "
                    f"expected a recording.mcap written by explore-bt run ({PROFILE!r})"
                )
            if isinstance(record, Chunk):
                contents.take(record)
            elif isinstance(record, Channel):  # repeated behind the last chunk
                contents.channels.setdefault(record.id, record)
            elif isinstance(record, Schema):
                contents.schemas.setdefault(record.id, record.name)
            contents.sound_bytes = file.tell()
        contents.whole = True
    except _BROKEN:
        pass  # the end of a cut file: every chunk before it has been kept
    return contents

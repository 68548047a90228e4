"""An MCAP file that closes its chunks on mission time, so that little is ever at stake."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from mcap.writer import Writer

from explore_bt.recording.schemas import is_known, schema_text
from explore_bt.recording.topics import PROFILE

__all__ = ["PERIOD_NS", "ChunkWriter"]

PERIOD_NS = 1_000_000_000
"""Mission time that a chunk covers, unless somebody asks for another."""


class ChunkWriter:
    """Writes JSON messages; what is older than ``period_ns`` of mission time is in the file.

    A chunk goes to the operating system as soon as it is closed, so a killed process loses only the
    one that was open.
    """

    def __init__(self, path: Path, version: str, period_ns: int) -> None:
        self._file = path.open("wb")
        self._writer = Writer(self._file)
        self._writer.start(profile=PROFILE, library=f"explore-bt {version}")
        self._period_ns = period_ns
        self._chunk_begin_ns: int | None = None
        self._channels: dict[str, int] = {}
        self._sequence: dict[int, int] = {}

    def register(self, topics: Iterable[tuple[str, str]]) -> None:
        """Declare topics: pairs of topic and schema name."""
        schemas: dict[str, int] = {}
        for topic, schema in topics:
            if not is_known(schema):  # written by another version
                self._channels[topic] = self._writer.register_channel(topic, "json", 0)
                continue
            if schema not in schemas:
                schemas[schema] = self._writer.register_schema(schema, "jsonschema", schema_text(schema))
            self._channels[topic] = self._writer.register_channel(topic, "json", schemas[schema])

    def is_due(self, time_ns: int) -> bool:
        """Whether the next message of that time goes into a chunk of its own."""
        return self._chunk_begin_ns is not None and time_ns - self._chunk_begin_ns >= self._period_ns

    def write(self, topic: str, time_ns: int, text: str) -> None:
        """Add a message; the chunk is closed first if this message is past its time."""
        # a lone surrogate in foreign text becomes its own JSON escape
        self.write_raw(topic, time_ns, text.encode("utf-8", "backslashreplace"))

    def write_raw(self, topic: str, time_ns: int, data: bytes) -> None:
        """The same for the bytes of one; a topic that was never declared becomes one without a schema."""
        if self._chunk_begin_ns is None:
            self._chunk_begin_ns = time_ns
        elif self.is_due(time_ns):
            self.flush()
            self._chunk_begin_ns = time_ns
        if topic not in self._channels:
            self._channels[topic] = self._writer.register_channel(topic, "json", 0)
        channel = self._channels[topic]
        sequence = self._sequence[channel] = self._sequence.get(channel, -1) + 1
        self._writer.add_message(channel, time_ns, data, time_ns, sequence)

    def flush(self) -> None:
        """Close the open chunk."""
        self._writer.flush()

    def move(self, path: Path) -> None:
        """Have what is written under another name, in place of what is there; writing goes on."""
        self._file.flush()
        os.fsync(self._file.fileno())
        os.replace(self._file.name, path)

    def close(self, path: Path | None = None) -> None:
        """Write the index and close the file, have it under another name then if one is given; idempotent."""
        if not self._file.closed:
            self._writer.finish()
            if path is not None:
                self.move(path)
            self._file.close()

"""The messages of a run by topic and time: of a file, or of a run that is still going on."""

from __future__ import annotations

import bisect
import json
import threading
from array import array
from collections import OrderedDict
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import zstandard

__all__ = ["LoggedMessage", "MessageLog"]

_AT_HAND = -1  # in place of a chunk
_UNPACKED = 32  # chunks kept unpacked; a seek touches about ten


@dataclass(frozen=True, slots=True)
class LoggedMessage:
    """A message as it was written: ``text`` is its JSON."""

    topic: str
    stamp_ns: int
    text: str

    @property
    def value(self) -> dict[str, Any]:
        """What the JSON says."""
        return json.loads(self.text)


class _Spot(NamedTuple):
    """Where a message lies: which of all it is, its chunk, its bytes therein."""

    order: int
    chunk: int
    begin: int
    end: int


@dataclass(slots=True)
class _Column:
    """The messages of one topic; ``before`` is the last of those that were given up."""

    stamps_ns: array[int] = field(default_factory=lambda: array("q"))
    spots: list[_Spot] = field(default_factory=list)
    before: LoggedMessage | None = None


class MessageLog:
    """Messages in compressed chunks, found by topic and time.

    One thread adds, any thread reads. A reader holds the writer up for a look-up in the index at most,
    never while it unpacks.

    Args:
        chunk_ns: mission time that goes into one chunk.
        limit_bytes: of compressed messages; beyond it the oldest chunk is given up, save the last
            message of each topic. None: no limit.
        at_hand: endings of topics whose messages are neither packed nor given up: few and short ones, of
            which a state needs all.
    """

    def __init__(
        self,
        chunk_ns: int = 1_000_000_000,
        limit_bytes: int | None = None,
        at_hand: tuple[str, ...] = ("/visited",),
    ) -> None:
        self._chunk_ns = chunk_ns
        self._limit_bytes = limit_bytes
        self._index_lock, self._unpack_lock = threading.Lock(), threading.Lock()
        self._columns: dict[str, _Column] = {}
        self._endings_at_hand = at_hand
        self._at_hand: list[LoggedMessage] = []
        self._packed: OrderedDict[int, bytes] = OrderedDict()
        self._unpacked: OrderedDict[int, bytes] = OrderedDict()
        self._packed_bytes = 0
        self._open = bytearray()
        self._open_index, self._open_begin_ns = 0, 0
        self._packer, self._unpacker = zstandard.ZstdCompressor(), zstandard.ZstdDecompressor()
        self._count = 0
        self.begin_ns = 0
        self.end_ns = 0

    def __len__(self) -> int:
        return self._count

    @property
    def topics(self) -> tuple[str, ...]:
        """Those of which there was a message, in the order of their first one."""
        with self._index_lock:
            return tuple(self._columns)

    def add(self, topic: str, stamp_ns: int, text: str) -> None:
        """Append a message; within a topic stamps never go back."""
        data = text.encode("utf-8", "backslashreplace")  # as the recorder writes it
        with self._index_lock:
            if self._open and stamp_ns - self._open_begin_ns >= self._chunk_ns:
                self._pack()
            if not self._open:
                self._open_begin_ns = stamp_ns
            column = self._columns.setdefault(topic, _Column())
            column.stamps_ns.append(stamp_ns)
            if topic.endswith(self._endings_at_hand):
                column.spots.append(_Spot(self._count, _AT_HAND, len(self._at_hand), 0))
                self._at_hand.append(LoggedMessage(topic, stamp_ns, data.decode()))
            else:
                begin = len(self._open)
                self._open += data
                column.spots.append(_Spot(self._count, self._open_index, begin, len(self._open)))
            self._count += 1
            self.end_ns = max(self.end_ns, stamp_ns)

    def last(self, topic: str, at_ns: int) -> LoggedMessage | None:
        """The newest message of a topic with ``stamp <= at_ns``."""
        with self._index_lock:
            column = self._columns.get(topic)
            if column is None:
                return None
            index = bisect.bisect_right(column.stamps_ns, at_ns) - 1
            if index < 0:
                return column.before if column.before and column.before.stamp_ns <= at_ns else None
            stamp_ns, spot = column.stamps_ns[index], column.spots[index]
        return self._read(topic, stamp_ns, spot)

    def between(self, topics: Collection[str], after_ns: int, until_ns: int) -> Iterator[LoggedMessage]:
        """Messages of these topics with ``after_ns < stamp <= until_ns``, in the order they came."""
        found: list[tuple[_Spot, str, int]] = []
        with self._index_lock:
            for topic in topics:
                if (column := self._columns.get(topic)) is None:
                    continue
                begin, end = (bisect.bisect_right(column.stamps_ns, each) for each in (after_ns, until_ns))
                stamps_ns = column.stamps_ns[begin:end]
                found += zip(column.spots[begin:end], [topic] * len(stamps_ns), stamps_ns, strict=True)
        for spot, topic, stamp_ns in sorted(found):
            if (message := self._read(topic, stamp_ns, spot)) is not None:
                yield message

    def after(self, topics: Collection[str], count: int, most: int) -> tuple[list[LoggedMessage], int]:
        """Up to ``most`` messages of these topics from the ``count``-th of all on, as they came.

        Returns:
            The messages, and the count to go on from.
        """
        found: list[tuple[_Spot, str, int]] = []
        with self._index_lock:
            for topic in topics:
                if (column := self._columns.get(topic)) is None:
                    continue
                begin = bisect.bisect_left(column.spots, (count,))
                end = begin + most + 1  # one more tells where to go on
                stamps_ns = column.stamps_ns[begin:end]
                found += zip(column.spots[begin:end], [topic] * len(stamps_ns), stamps_ns, strict=True)
            so_far = self._count
        found.sort()
        rest = found[most:]
        messages = (self._read(topic, stamp_ns, spot) for spot, topic, stamp_ns in found[:most])
        return [each for each in messages if each is not None], rest[0][0].order if rest else so_far

    def _read(self, topic: str, stamp_ns: int, spot: _Spot) -> LoggedMessage | None:
        """None for what was given up since it was found."""
        if spot.chunk == _AT_HAND:
            return self._at_hand[spot.begin]
        with self._index_lock:
            if spot.chunk == self._open_index:
                data = bytes(self._open[spot.begin : spot.end])
                return LoggedMessage(topic, stamp_ns, data.decode())
            packed = self._packed.get(spot.chunk)
        if packed is None:
            return None
        with self._unpack_lock:
            plain = self._unpacked.get(spot.chunk)
            if plain is None:
                plain = self._unpacked[spot.chunk] = self._unpacker.decompress(packed)
                if len(self._unpacked) > _UNPACKED:
                    self._unpacked.popitem(last=False)
            else:
                self._unpacked.move_to_end(spot.chunk)
        return LoggedMessage(topic, stamp_ns, plain[spot.begin : spot.end].decode())

    def _pack(self) -> None:
        packed = self._packed[self._open_index] = self._packer.compress(bytes(self._open))
        self._packed_bytes += len(packed)
        self._open.clear()
        self._open_index += 1
        while self._limit_bytes is not None and self._packed_bytes > self._limit_bytes and self._packed:
            self._give_up()

    def _give_up(self) -> None:
        chunk, packed = self._packed.popitem(last=False)
        self._packed_bytes -= len(packed)
        plain = zstandard.ZstdDecompressor().decompress(packed)  # rare, and the other one may be in use
        for topic, column in self._columns.items():
            count = bisect.bisect_right(column.spots, chunk, key=lambda spot: spot.chunk)
            if not count or column.spots[0].chunk == _AT_HAND:
                continue
            stamp_ns, spot = column.stamps_ns[count - 1], column.spots[count - 1]
            column.before = LoggedMessage(topic, stamp_ns, plain[spot.begin : spot.end].decode())
            self.begin_ns = max(self.begin_ns, stamp_ns)
            del column.stamps_ns[:count], column.spots[:count]

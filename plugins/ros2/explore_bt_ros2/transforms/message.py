"""``tf2_msgs/TFMessage`` as the bytes that go over the wire (OMG CDR, as XCDR1 aligns it)."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable

from explore_bt_ros2.transforms.transform import Transform

__all__ = ["decode", "encode"]

_LITTLE = b"\x00\x01\x00\x00"
_MOST = 10_000


def encode(transforms: Iterable[Transform]) -> bytes:
    """The message with these transforms."""
    listed = list(transforms)
    body = bytearray(struct.pack("<I", len(listed)))
    for each in listed:
        _pad(body, 4)
        second = math.floor(each.stamp_s)
        body += struct.pack("<iI", second, min(round(1e9 * (each.stamp_s - second)), 999_999_999))
        _put_text(body, each.parent)
        _put_text(body, each.child)
        _pad(body, 8)
        body += struct.pack("<7d", *each.shift, *each.turn)
    return _LITTLE + bytes(body)


def decode(data: bytes) -> list[Transform]:
    """The transforms of a message.

    Raises:
        ValueError: not a message of this type, or a transform that is none.
    """
    order = {0: ">", 1: "<"}.get(data[1] if len(data) > 1 else -1)
    if order is None:
        raise ValueError(f"{len(data)} bytes are no TFMessage")
    try:
        return _Reader(data[4:], order).transforms()
    except (struct.error, UnicodeDecodeError) as fault:
        raise ValueError(f"{len(data)} bytes are no TFMessage: {fault}") from None


class _Reader:
    """Takes values one by one; positions count from behind the four bytes of the header."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body = body
        self._order = order
        self._at = 0

    def transforms(self) -> list[Transform]:
        count = int(self._take("I")[0])
        if count > _MOST:
            raise ValueError(f"a TFMessage of {count} transforms")
        return [self._transform() for _ in range(count)]

    def _transform(self) -> Transform:
        second, nanosecond = self._take("iI")
        parent, child = self._text(), self._text()
        values = self._take("7d")
        length = math.sqrt(sum(value * value for value in values[3:]))
        if not (all(map(math.isfinite, values)) and length > 1e-6):
            raise ValueError(f"the transform from {parent} to {child} is {values}")
        x, y, z, w = (value / length for value in values[3:])
        shift = (values[0], values[1], values[2])
        return Transform(second + 1e-9 * nanosecond, parent, child, shift, (x, y, z, w))

    def _take(self, layout: str) -> tuple[float, ...]:
        size = 8 if layout.endswith("d") else 4
        self._at += -self._at % size
        values = struct.unpack_from(self._order + layout, self._body, self._at)
        self._at += struct.calcsize(self._order + layout)
        return values

    def _text(self) -> str:
        (length,) = self._take("I")
        end = self._at + int(length)
        if end > len(self._body):
            raise ValueError("a TFMessage that is cut off")
        text = self._body[self._at : end].rstrip(b"\0").decode()
        self._at = end
        return text.lstrip("/")


def _put_text(body: bytearray, text: str) -> None:
    _pad(body, 4)
    data = text.encode() + b"\0"
    body += struct.pack("<I", len(data)) + data


def _pad(body: bytearray, size: int) -> None:
    body += bytes(-len(body) % size)

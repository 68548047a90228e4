"""Figures about robots, each with the name of the robot, as bytes."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from typing import Any

__all__ = ["named_from", "named_to_bytes"]

_LENGTH = struct.Struct("<B")


def named_to_bytes(layout: struct.Struct, told: Mapping[str, tuple[Any, ...]]) -> bytes:
    """For each name its figures, little endian as laid out, the length of the name, and the name in UTF-8."""
    parts = []
    for name, figures in told.items():
        text = name.encode()
        parts.append(layout.pack(*figures) + _LENGTH.pack(len(text)) + text)
    return b"".join(parts)


def named_from(layout: struct.Struct, body: bytes) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """What ``named_to_bytes`` was given.

    Raises:
        ValueError, struct.error: cut off or damaged.
    """
    at = 0
    while at < len(body):
        figures = layout.unpack_from(body, at)
        at += layout.size
        (length,) = _LENGTH.unpack_from(body, at)
        at += _LENGTH.size + length
        if at > len(body):
            raise ValueError("a name is cut off")
        yield body[at - length : at].decode(), figures

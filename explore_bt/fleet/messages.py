"""What robots tell one another, and its bytes: the same whatever carries them."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import ExploreError
from explore_bt.fleet.clocks import Clocks, clocks_from, clocks_to_bytes
from explore_bt.fleet.graph_messages import (
    Fits,
    fits_from,
    fits_to_bytes,
    keyframe_from,
    keyframe_to_bytes,
    stretch_from,
    stretch_to_bytes,
)
from explore_bt.types import Doing, Pose2, SharedKeyframe, SharedStretch, Twist2

__all__ = ["MESSAGE_VERSION", "Message", "MessageError", "Presence", "Tile", "decode", "encode"]

MESSAGE_VERSION = 2
"""Of the bytes: robots of another version are heard of, but not understood."""

_HEAD = struct.Struct("<BB")
_PRESENCE = struct.Struct("<dd3d2fff2BhHHH")
_TILE = struct.Struct("<Qfii")
_KNOWS_START, _SHARES_GRAPH = 1, 2
_STEP_M = 0.005
"""Places near the robot are told to half a centimetre, from it."""
_CLAIM_STEP_M = 0.001
_DOINGS = tuple(Doing)
_MOST_BYTES = 1 << 20


class MessageError(ExploreError):
    """Bytes that are no message of this version."""


@dataclass(frozen=True, slots=True, eq=False)
class Presence:
    """Where a robot is and what it is about; see ``types.Mate``. Times are the sender's.

    Attributes:
        stop, ahead: (N, 2) float64, metres, ``map`` frame.
        knows_start: its ``map`` frame is the one that all robots share whose start was given.
        shares_graph: it tells keyframes, by which its start can be checked.
    """

    stamp_s: float
    binding_s: float
    T_map_base: Pose2
    twist: Twist2
    radius_m: float
    speed_limit_mps: float
    stop: NDArray[np.float64]
    ahead: NDArray[np.float64]
    claims: tuple[tuple[float, float], ...] = ()
    doing: Doing = Doing.AT_WORK
    yields: int = 0
    knows_start: bool = True
    shares_graph: bool = False

    def moved(self, T_ours_theirs: Pose2) -> Presence:
        """The same in another robot's ``map`` frame."""
        claims = T_ours_theirs.apply(np.array(self.claims).reshape(-1, 2)).tolist()
        return replace(
            self,
            T_map_base=T_ours_theirs.compose(self.T_map_base),
            stop=T_ours_theirs.apply(self.stop.reshape(-1, 2)),
            ahead=T_ours_theirs.apply(self.ahead.reshape(-1, 2)),
            claims=tuple((x, y) for x, y in claims),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """A square of a robot's own map, on a lattice through the origin of the ``map`` frame.

    Attributes:
        revision: of two tiles of one robot and place the one with the larger counts.
        place: column and row of the tile on the lattice: whole multiples of its side.
        cells: (n, n) int8, as in ``OccupancyGrid``.
    """

    revision: int
    resolution_m: float
    place: tuple[int, int]
    cells: NDArray[np.int8]


Message = Presence | Tile | Clocks | Fits | SharedKeyframe | SharedStretch


def encode(message: Message) -> bytes:
    """The bytes; little endian, lengths first."""
    kind, to_bytes = _WRITERS[type(message)]
    return _HEAD.pack(MESSAGE_VERSION, kind) + to_bytes(message)


def decode(payload: bytes) -> Message:
    """The message.

    Raises:
        MessageError: cut off, of another version, or no message at all.
    """
    if len(payload) < _HEAD.size or len(payload) > _MOST_BYTES:
        raise MessageError(f"{len(payload)} bytes are no message of explore-bt")
    version, kind = _HEAD.unpack_from(payload)
    if version != MESSAGE_VERSION:
        raise MessageError(f"a message of version {version}; this explore-bt understands {MESSAGE_VERSION}")
    try:
        if kind not in _READERS:
            raise ValueError("there is no such kind")
        return _READERS[kind](payload[_HEAD.size :])
    except (struct.error, zlib.error, ValueError, IndexError) as fault:
        raise MessageError(f"a message of kind {kind} is cut off or damaged: {fault}") from None


def _presence_bytes(told: Presence) -> bytes:
    pose = told.T_map_base
    head = _PRESENCE.pack(
        told.stamp_s,
        told.binding_s,
        pose.x,
        pose.y,
        pose.yaw_rad,
        told.twist.linear_mps,
        told.twist.angular_rps,
        told.radius_m,
        told.speed_limit_mps,
        _DOINGS.index(told.doing),
        _KNOWS_START * told.knows_start | _SHARES_GRAPH * told.shares_graph,
        told.yields,
        len(told.stop),
        len(told.ahead),
        len(told.claims),
    )
    claims = np.rint(np.array(told.claims).reshape(-1, 2) / _CLAIM_STEP_M).astype("<i4")
    return head + _near_bytes(told.stop, pose) + _near_bytes(told.ahead, pose) + claims.tobytes()


def _near_bytes(points: NDArray[np.float64], pose: Pose2) -> bytes:
    steps = np.rint((points.reshape(-1, 2) - pose.xy) / _STEP_M)
    return np.clip(steps, -32768, 32767).astype("<i2").tobytes()


def _presence(body: bytes) -> Presence:
    stamp, binding, x, y, yaw, v, w, radius, speed, doing, flags, yields, *counts = _PRESENCE.unpack_from(
        body
    )
    if not np.isfinite([stamp, binding, x, y, yaw, v, w, radius, speed]).all():
        raise ValueError("a number is not finite")
    at = _PRESENCE.size
    stop, ahead, claims = _split(body[at:], (4 * counts[0], 4 * counts[1], 8 * counts[2]))
    near = [np.frombuffer(part, "<i2").reshape(-1, 2) * _STEP_M + (x, y) for part in (stop, ahead)]
    places = np.frombuffer(claims, "<i4").reshape(-1, 2) * _CLAIM_STEP_M
    return Presence(
        stamp,
        binding,
        Pose2(x, y, yaw),
        Twist2(v, w),
        radius,
        speed,
        near[0],
        near[1],
        tuple((float(a), float(b)) for a, b in places),
        _DOINGS[doing],
        yields,
        bool(flags & _KNOWS_START),
        bool(flags & _SHARES_GRAPH),
    )


def _split(body: bytes, sizes: Sequence[int]) -> list[bytes]:
    if len(body) != sum(sizes):
        raise ValueError(f"{len(body)} bytes of places, expected {sum(sizes)}")
    ends = np.cumsum(sizes).tolist()
    return [body[end - size : end] for end, size in zip(ends, sizes, strict=True)]


def _tile_bytes(tile: Tile) -> bytes:
    """Two bits a cell, then zlib: a few hundred bytes for 64 by 64 cells."""
    codes = np.where(tile.cells < 0, 2, np.where(tile.cells > 0, 1, 0)).astype(np.uint8).ravel()
    four = np.pad(codes, (0, -len(codes) % 4)).reshape(-1, 4)
    packed = four[:, 0] | four[:, 1] << 2 | four[:, 2] << 4 | four[:, 3] << 6
    head = _TILE.pack(tile.revision, tile.resolution_m, *tile.place)
    return head + struct.pack("<H", len(tile.cells)) + zlib.compress(packed.tobytes(), 6)


def _tile(body: bytes) -> Tile:
    revision, resolution_m, col, row = _TILE.unpack_from(body)
    (side,) = struct.unpack_from("<H", body, _TILE.size)
    if not (np.isfinite(resolution_m) and resolution_m > 0.0):
        raise ValueError(f"a resolution of {resolution_m}")
    inflate = zlib.decompressobj()
    packed = np.frombuffer(inflate.decompress(body[_TILE.size + 2 :], side * side), np.uint8)
    codes = np.stack([packed >> shift & 3 for shift in (0, 2, 4, 6)], axis=1).ravel()[: side * side]
    cells = np.array([0, 100, -1, -1], dtype=np.int8)[codes].reshape(side, side)
    cells.flags.writeable = False
    return Tile(revision, round(resolution_m, 6), (col, row), cells)


_KINDS: Sequence[tuple[int, type[Message], Callable[[Any], bytes], Callable[[bytes], Message]]] = (
    (1, Presence, _presence_bytes, _presence),
    (2, Tile, _tile_bytes, _tile),
    (3, Clocks, clocks_to_bytes, clocks_from),
    (4, SharedKeyframe, keyframe_to_bytes, keyframe_from),
    (5, SharedStretch, stretch_to_bytes, stretch_from),
    (6, Fits, fits_to_bytes, fits_from),
)
_WRITERS = {type_: (kind, to_bytes) for kind, type_, to_bytes, _ in _KINDS}
_READERS = {kind: from_bytes for kind, _, _, from_bytes in _KINDS}

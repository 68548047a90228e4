"""The bytes of keyframes and of stretches of a pose graph."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.fleet.named import named_from, named_to_bytes
from explore_bt.types import STRETCH_KEYFRAMES, Pose2, SharedEdge, SharedKeyframe, SharedStretch

__all__ = [
    "Fits",
    "fits_from",
    "fits_to_bytes",
    "keyframe_from",
    "keyframe_to_bytes",
    "stretch_from",
    "stretch_to_bytes",
]

_FIT = struct.Struct("<ddd")
_KEYFRAME = struct.Struct("<IddH")
_STRETCH = struct.Struct("<IBH")
_EDGE = np.dtype(
    [("a", "<u4"), ("b", "<u4"), ("relative", "<f4", 3), ("spread", "<f4", 6), ("closure", "u1")]
)
_POINT_STEP_M = 0.005
_UPPER = np.triu_indices(3)
_MOST_POINTS = 1 << 14


@dataclass(frozen=True, slots=True)
class Fits:
    """How the maps of mates lie in the teller's, as closures have told it.

    Attributes:
        T_ours_theirs: by the mate's name.
    """

    T_ours_theirs: Mapping[str, Pose2]


def fits_to_bytes(told: Fits) -> bytes:
    """For each mate x, y, yaw."""
    return named_to_bytes(_FIT, {name: (T.x, T.y, T.yaw_rad) for name, T in told.T_ours_theirs.items()})


def fits_from(body: bytes) -> Fits:
    """What ``fits_to_bytes`` was given.

    Raises:
        ValueError, struct.error: cut off or damaged.
    """
    found = dict(named_from(_FIT, body))
    if not all(np.isfinite(figures).all() for figures in found.values()):
        raise ValueError("a number is not finite")
    return Fits({name: Pose2(*figures) for name, figures in found.items()})


def keyframe_to_bytes(told: SharedKeyframe) -> bytes:
    """Points to half a centimetre, each from the one before it, compressed: some hundred bytes."""
    steps = np.clip(np.rint(told.points / _POINT_STEP_M), -32768, 32767).astype("<i2")
    differences = np.diff(steps, axis=0, prepend=np.zeros((1, 2), "<i2"))  # wraps round, and back again
    packed = zlib.compress(differences.astype("<i2").T.tobytes(), 6)
    return _KEYFRAME.pack(told.number, told.stamp_s, told.driven_m, len(steps)) + packed


def keyframe_from(body: bytes) -> SharedKeyframe:
    """What ``keyframe_to_bytes`` was given, to half a centimetre.

    Raises:
        ValueError, struct.error, zlib.error: cut off or damaged.
    """
    number, stamp_s, driven_m, count = _KEYFRAME.unpack_from(body)
    if count > _MOST_POINTS or not np.isfinite([stamp_s, driven_m]).all():
        raise ValueError(f"a keyframe of {count} points at {stamp_s} s")
    raw = zlib.decompressobj().decompress(body[_KEYFRAME.size :], 4 * count + 1)
    differences = np.frombuffer(raw, "<i2").reshape(2, count).T
    points = np.cumsum(differences, axis=0, dtype=np.int16).astype(np.float64) * _POINT_STEP_M
    return SharedKeyframe(number, stamp_s, driven_m, points)


def stretch_to_bytes(told: SharedStretch) -> bytes:
    """Poses and constraints as single floats."""
    edges = np.zeros(len(told.edges), _EDGE)
    for row, edge in zip(edges, told.edges, strict=True):
        row["a"], row["b"], row["closure"] = edge.a, edge.b, edge.is_closure
        row["relative"], row["spread"] = edge.relative.as_array(), edge.covariance[_UPPER]
    head = _STRETCH.pack(told.number, len(told.poses), len(edges))
    return head + told.poses.astype("<f4").tobytes() + edges.tobytes()


def stretch_from(body: bytes) -> SharedStretch:
    """What ``stretch_to_bytes`` was given.

    Raises:
        ValueError, struct.error: cut off or damaged.
    """
    number, count, edge_count = _STRETCH.unpack_from(body)
    at = _STRETCH.size + 12 * count
    if count > STRETCH_KEYFRAMES or len(body) != at + edge_count * _EDGE.itemsize:
        raise ValueError(f"{len(body)} bytes for {count} keyframes and {edge_count} constraints")
    poses = np.frombuffer(body[_STRETCH.size : at], "<f4").reshape(-1, 3).astype(np.float64)
    rows = np.frombuffer(body[at:], _EDGE)
    if not all(np.isfinite(values).all() for values in (poses, rows["relative"], rows["spread"])):
        raise ValueError("a number is not finite")
    first = number * STRETCH_KEYFRAMES
    if not ((rows["a"] < rows["b"]) & (rows["b"] >= first) & (rows["b"] < first + count)).all():
        raise ValueError("a constraint does not end in the stretch")
    return SharedStretch(number, poses, tuple(_edge(row) for row in rows))


def _edge(row: np.void) -> SharedEdge:
    covariance: NDArray[np.float64] = np.zeros((3, 3))
    covariance[_UPPER] = row["spread"]
    covariance = covariance + np.triu(covariance, 1).T
    if np.linalg.eigvalsh(covariance)[0] <= 0.0:
        raise ValueError("a covariance is none")
    relative = Pose2(*row["relative"].astype(np.float64).tolist())
    return SharedEdge(int(row["a"]), int(row["b"]), relative, covariance, bool(row["closure"]))

"""All sights, and which of them look like a new one: an index whose cost does not grow with the map."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_slam.arrays import Ints, Ints32
from explore_bt_slam.sight import Sight

__all__ = ["SightStore"]

_TABLES = 6
_BITS = 14
_NEAR_BITS = 50
_LONGEST = 48
_BIT_CHOICE = np.random.default_rng(0).permutation(256)[: _TABLES * _BITS].reshape(_TABLES, _BITS)


class SightStore:
    """Sights by keyframe, found again through locality-sensitive hashing.

    Each descriptor is filed under six words of 14 of its 256 bits (bit sampling, Indyk and Motwani 1998;
    nothing to train); two descriptors that share a word are compared in full. At most 48 entries of a word
    are looked at, the newest first, and at most ``capacity`` sights are kept: when they are full, every
    second one is forgotten. So time and memory are bounded however long the robot drives.

    Args:
        capacity: sights kept at most, about 23 kB each with the index.
    """

    def __init__(self, capacity: int = 2000) -> None:
        self._capacity = capacity
        self._sights: list[Sight] = []
        self._keyframes: list[int] = []
        self._clear_index()

    @property
    def sights(self) -> list[Sight]:
        """All that are kept, in the order they came; do not write."""
        return self._sights

    @property
    def keyframes(self) -> list[int]:
        """The keyframe of each; do not write."""
        return self._keyframes

    def add(self, keyframe: int, sight: Sight) -> None:
        """Keep a sight of a keyframe."""
        if len(self._sights) == self._capacity:
            self._sights, self._keyframes = self._sights[::2], self._keyframes[::2]
            self._clear_index()
            for number, kept in enumerate(self._sights):
                self._file(number, kept)
        self._sights.append(sight)
        self._keyframes.append(keyframe)
        self._file(len(self._sights) - 1, sight)

    def votes(self, sight: Sight) -> NDArray[np.int32]:
        """(sights,) int32: how many features of ``sight`` have a like one in each."""
        return _votes(
            self._heads,
            self._following,
            self._owners,
            self._words,
            _as_words(sight.descriptors),
            _keys(sight.descriptors),
            len(self._sights),
            _NEAR_BITS,
            _LONGEST,
        )

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All sights, for a file."""
        none = Sight(np.zeros((0, 32), np.uint8), np.zeros((0, 3), np.float32), np.zeros(0, np.float32))
        sights = [none, *self._sights]
        return {
            "sight_keyframes": np.array(self._keyframes, dtype=np.int64),
            "sight_counts": np.array([sight.points.shape[0] for sight in self._sights], dtype=np.int64),
            "sight_descriptors": np.concatenate([sight.descriptors for sight in sights]),
            "sight_points": np.concatenate([sight.points for sight in sights]),
            "sight_sigmas": np.concatenate([sight.sigmas_m for sight in sights]),
        }

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Add what ``arrays`` gave; nothing where a map was saved without a camera."""
        if "sight_keyframes" not in arrays:
            return
        ends = np.cumsum(arrays["sight_counts"])
        for keyframe, end, count in zip(
            arrays["sight_keyframes"].tolist(), ends.tolist(), arrays["sight_counts"].tolist(), strict=True
        ):
            own = slice(end - count, end)
            parts = (arrays[f"sight_{name}"][own] for name in ("descriptors", "points", "sigmas"))
            self.add(keyframe, Sight(*parts))

    def _clear_index(self) -> None:
        self._heads = np.full((_TABLES, 1 << _BITS), -1, dtype=np.int32)
        self._following = np.zeros((1024, _TABLES), dtype=np.int32)
        self._owners = np.zeros(1024, dtype=np.int32)
        self._words = np.zeros((1024, 4), dtype=np.uint64)
        self._count = 0

    def _file(self, number: int, sight: Sight) -> None:
        begin, end = self._count, self._count + sight.descriptors.shape[0]
        while end > self._owners.shape[0]:
            self._following = np.concatenate((self._following, np.zeros_like(self._following)))
            self._owners = np.concatenate((self._owners, np.zeros_like(self._owners)))
            self._words = np.concatenate((self._words, np.zeros_like(self._words)))
        self._owners[begin:end] = number
        self._words[begin:end] = _as_words(sight.descriptors)
        _link(self._heads, self._following, _keys(sight.descriptors), begin)
        self._count = end


def _as_words(descriptors: NDArray[np.uint8]) -> NDArray[np.uint64]:
    """(N, 4) uint64: the same 256 bits."""
    return np.ascontiguousarray(descriptors).view(np.uint64).reshape(-1, 4)


def _keys(descriptors: NDArray[np.uint8]) -> NDArray[np.int64]:
    """(N, 6) int64: the sampled bits of each descriptor, read as one number a table."""
    bits = np.unpackbits(descriptors, axis=1)
    return np.asarray(bits[:, _BIT_CHOICE].astype(np.int64) @ (1 << np.arange(_BITS, dtype=np.int64)))


@njit(cache=True)
def _link(heads: Ints32, following: Ints32, keys: Ints, begin: int) -> None:
    for i in range(keys.shape[0]):
        for t in range(keys.shape[1]):
            following[begin + i, t] = heads[t, keys[i, t]]
            heads[t, keys[i, t]] = begin + i


@njit(cache=True)
def _distance(a: NDArray[np.uint64], b: NDArray[np.uint64]) -> int:
    """How many of 256 bits differ."""
    total = 0
    for k in range(4):
        x = a[k] ^ b[k]
        x = x - ((x >> np.uint64(1)) & np.uint64(0x5555555555555555))
        x = (x & np.uint64(0x3333333333333333)) + ((x >> np.uint64(2)) & np.uint64(0x3333333333333333))
        x = (x + (x >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
        total += int((x * np.uint64(0x0101010101010101)) >> np.uint64(56))
    return total


@njit(cache=True)
def _votes(
    heads: Ints32,
    following: Ints32,
    owners: Ints32,
    words: NDArray[np.uint64],
    query: NDArray[np.uint64],
    keys: Ints,
    count: int,
    near: int,
    longest: int,
) -> Ints32:
    votes = np.zeros(count, np.int32)
    last = np.full(count, -1, np.int32)
    for q in range(query.shape[0]):
        for t in range(keys.shape[1]):
            entry, walked = heads[t, keys[q, t]], 0
            while entry >= 0 and walked < longest:
                owner = owners[entry]
                if last[owner] != q and _distance(words[entry], query[q]) <= near:
                    votes[owner] += 1
                    last[owner] = q
                entry, walked = following[entry, t], walked + 1
    return votes

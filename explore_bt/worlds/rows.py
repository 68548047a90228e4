"""Rooms side by side along a corridor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explore_bt.worlds.plan import Box, Space, rounded

__all__ = ["RoomKind", "Titles", "fill_row"]

_TRIES = 400


@dataclass(frozen=True, slots=True)
class RoomKind:
    """How wide rooms of a kind are, metres, how often they come, and how many a row may have."""

    kind: str
    least_m: float
    most_m: float
    weight: float = 1.0
    most: int = 99


class Titles:
    """Names for spaces: ``bedroom``, ``bedroom 2``."""

    def __init__(self) -> None:
        self._count: dict[str, int] = {}

    def of(self, kind: str) -> str:
        """The next name of a kind."""
        self._count[kind] = self._count.get(kind, 0) + 1
        return kind if self._count[kind] == 1 else f"{kind} {self._count[kind]}"


def fill_row(
    rng: np.random.Generator,
    titles: Titles,
    kinds: Sequence[RoomKind],
    begin: tuple[float, float],
    length_m: float,
    depth_m: float,
    needed: Sequence[str] = (),
) -> list[Space]:
    """Rooms from left to right that fill a strip.

    Args:
        rng: of all choices.
        titles: gives the names.
        kinds: to choose from.
        begin: x, y of the strip's lower left corner, metres.
        length_m: along x; at least the widest kind's least width.
        depth_m: along y.
        needed: kinds that must be among them, if it can be.
    """
    chosen = _choose(rng, kinds, length_m, needed) or _choose(rng, kinds, length_m, ())
    least, most = (np.array([getattr(kind, name) for kind in chosen]) for name in ("least_m", "most_m"))
    spare = (length_m - least.sum()) * (share := (most - least) * rng.uniform(0.5, 1.0, len(chosen)) + 1e-9)
    ends = np.cumsum(least + spare / share.sum())
    corners = [
        begin[0],
        *(rounded(begin[0] + end) for end in ends[:-1].tolist()),
        rounded(begin[0] + length_m),
    ]
    low, high = begin[1], rounded(begin[1] + depth_m)
    return [
        Space(titles.of(kind.kind), kind.kind, Box(x0, low, x1, high))
        for kind, x0, x1 in zip(chosen, corners, corners[1:], strict=False)
    ]


def _choose(
    rng: np.random.Generator, kinds: Sequence[RoomKind], length_m: float, needed: Sequence[str]
) -> list[RoomKind]:
    """Kinds that can fill the length, in random order; none if no draw could."""
    weights = np.array([kind.weight for kind in kinds])
    for _ in range(_TRIES):
        drawn = [kind for kind in kinds if kind.kind in needed]
        while sum(kind.most_m for kind in drawn) < length_m:
            drawn.append(kinds[int(rng.choice(len(kinds), p=weights / weights.sum()))])
        fits = sum(kind.least_m for kind in drawn) <= length_m
        if fits and all(sum(other is kind for other in drawn) <= kind.most for kind in kinds):
            return [drawn[i] for i in rng.permutation(len(drawn))]
    if needed:
        return []
    widest = max(kinds, key=lambda kind: kind.most_m)
    count = max(round(length_m / widest.most_m), 1)
    return [RoomKind(widest.kind, length_m / count, length_m / count)] * count

"""How long words were under way, though no two robots have the same clock."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field

from explore_bt.fleet.named import named_from, named_to_bytes

__all__ = ["UNMEASURED_S", "Clocks", "WordAges", "clocks_from", "clocks_to_bytes"]

UNMEASURED_S = 1.0
"""A word counts as so old while nobody has told how long the way to its speaker takes."""
_WINDOW_S = 3.0
"""Simulated clocks slip against one another: what was found longer ago than twice this is forgotten."""
_HEAD = struct.Struct("<QB")
_LEAD = struct.Struct("<Qd")


@dataclass(frozen=True, slots=True)
class Clocks:
    """What a robot has found out about the clocks of the others.

    Attributes:
        life: of the robot that tells; another one after a restart.
        leads: mate -> its life, and the least that the teller's clock showed beyond the stamp of a word of it
            when that word was heard, seconds: what the clocks differ by, and the fastest way.
    """

    life: int
    leads: Mapping[str, tuple[int, float]] = field(default_factory=dict)


def clocks_to_bytes(told: Clocks) -> bytes:
    """The life, how many leads there are, and these."""
    return _HEAD.pack(told.life, len(told.leads)) + named_to_bytes(_LEAD, told.leads)


def clocks_from(body: bytes) -> Clocks:
    """What ``clocks_to_bytes`` was given.

    Raises:
        ValueError, struct.error: cut off or damaged.
    """
    life, count = _HEAD.unpack_from(body)
    leads = list(named_from(_LEAD, body[_HEAD.size :]))
    if len(leads) != count or not all(math.isfinite(lead_s) for _, (_, lead_s) in leads):
        raise ValueError(f"{len(leads)} leads of {count}, or a number is not finite")
    return Clocks(life, {name: (of, lead_s) for name, (of, lead_s) in leads})


class WordAges:
    """Bounds how old a word is when it is heard, by the way there and back.

    Every robot tells each other one the least lead of its own clock over that one's words. Added to the lead
    of one's own clock over a word, the clocks' difference cancels out: what is left is this word's way, and
    the fastest way back. A word is never older than that, whatever the network and the clocks.

    Args:
        name: the robot's.
        life: of the robot; another one after a restart.
    """

    def __init__(self, name: str, life: int) -> None:
        self._name, self._life = name, life
        self._mates: dict[str, _Clock] = {}
        self._count, self._sum_s, self._most_s = 0, 0.0, 0.0
        self._freshness = _Least()

    def bound_s(self, sender: str, stamp_s: float, now_s: float) -> float:
        """A word is heard: how old it is at most.

        Args:
            sender: who speaks.
            stamp_s: on its clock, when it spoke.
            now_s: on one's own.
        """
        clock = self._mates.setdefault(sender, _Clock())
        clock.lead_s.note(now_s - stamp_s, now_s)
        if clock.way_back_s is None:
            return UNMEASURED_S
        age_s = max(now_s - stamp_s + clock.way_back_s, 0.0)
        self._count, self._sum_s = self._count + 1, self._sum_s + age_s
        self._most_s = max(self._most_s, age_s)
        self._freshness.note(-age_s, now_s)
        return age_s

    def hear(self, sender: str, told: Clocks) -> None:
        """A mate tells what it has found out; one that was started anew has another clock."""
        if told.life != self._mates.setdefault(sender, _Clock()).life:
            self._mates[sender] = _Clock(told.life)
        life, lead_s = told.leads.get(self._name, (0, 0.0))
        if life == self._life:
            self._mates[sender].way_back_s = lead_s

    @property
    def recent_s(self) -> float:
        """The most of the bounds of the last seconds; 0 where nothing was bounded."""
        return max(-self._freshness.value, 0.0)

    def figures(self) -> Mapping[str, float]:
        """Mean and most of all bounds so far, seconds; 0 while nothing is measured."""
        return {"word_age_mean_s": self._sum_s / max(self._count, 1), "word_age_most_s": self._most_s}

    def tell(self) -> Clocks:
        """What the others need to know."""
        known = {
            name: clock
            for name, clock in self._mates.items()
            if clock.life and math.isfinite(clock.lead_s.value)  # else none of its words has come yet
        }
        return Clocks(self._life, {name: (clock.life, clock.lead_s.value) for name, clock in known.items()})


@dataclass(slots=True)
class _Least:
    """The least of the last ``_WINDOW_S`` to twice as long; infinite for nothing."""

    _now: float = math.inf
    _before: float = math.inf
    _since_s: float = -math.inf

    def note(self, value: float, now_s: float) -> None:
        if now_s - self._since_s > _WINDOW_S:
            self._before, self._now, self._since_s = self._now, math.inf, now_s
        self._now = min(self._now, value)

    @property
    def value(self) -> float:
        return min(self._now, self._before)


@dataclass(slots=True)
class _Clock:
    """One life of a mate: how far one's own clock is ahead of its words, at least."""

    life: int = 0
    way_back_s: float | None = None
    lead_s: _Least = field(default_factory=_Least)

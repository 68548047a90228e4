"""Who is in the team at the moment."""

from __future__ import annotations

from explore_bt.fleet.frames import SAME
from explore_bt.fleet.messages import Presence
from explore_bt.types import MapFit, Mate

__all__ = ["PRESENT_S", "Roster"]

PRESENT_S = 5.0
"""A robot that has been silent for so long is no mate: its claims are free. It may come back."""


class Roster:
    """What the others last told, on the listener's clock and in its ``map`` frame."""

    def __init__(self) -> None:
        self._told: dict[str, Presence] = {}
        self._heard_s: dict[str, float] = {}
        self._mates: dict[str, Mate] = {}

    def take(self, sender: str, told: Presence, now_s: float, stamp_s: float, way: MapFit | None) -> bool:
        """Note what a mate tells; whether it is news. After a restart its clock may begin anew.

        Args:
            sender: the mate.
            told: with times on its clock.
            now_s: on the listener's.
            stamp_s: on the listener's too, it was told then or later.
            way: how the mate's map lies in the listener's; None if nobody knows: it is there, but no mate.
        """
        before = self._told.get(sender)
        is_known = now_s - self._heard_s.get(sender, -PRESENT_S) < PRESENT_S
        if before is not None and is_known and told.stamp_s <= before.stamp_s:
            return False
        self._told[sender], self._heard_s[sender] = told, stamp_s
        if way is None:
            self._mates.pop(sender, None)
            return True
        if way is not SAME:
            told = told.moved(way.at_theirs(*told.T_map_base.xy))
        self._mates[sender] = Mate(
            sender,
            stamp_s,
            stamp_s + told.binding_s - told.stamp_s,
            told.T_map_base,
            told.twist,
            told.radius_m,
            told.speed_limit_mps,
            told.stop,
            told.ahead,
            told.claims,
            told.doing,
            told.yields,
        )
        return True

    def heard(self, now_s: float) -> frozenset[str]:
        """Everybody who was heard of lately, also those of whom nobody knows where they are."""
        return frozenset(name for name, stamp_s in self._heard_s.items() if now_s - stamp_s < PRESENT_S)

    def present(self, now_s: float, within_s: float = PRESENT_S) -> tuple[Mate, ...]:
        """Those who were heard of so lately, by name."""
        mates = (self._mates[name] for name in sorted(self._mates))
        return tuple(mate for mate in mates if now_s - mate.stamp_s < within_s)

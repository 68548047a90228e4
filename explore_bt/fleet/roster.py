"""Who is in the team at the moment."""

from __future__ import annotations

from explore_bt.fleet.messages import Presence
from explore_bt.types import Mate

__all__ = ["PRESENT_S", "Roster"]

PRESENT_S = 5.0
"""A robot that has been silent for so long is no mate: its claims are free. It may come back."""


class Roster:
    """What the others last told, on the listener's clock."""

    def __init__(self) -> None:
        self._told: dict[str, Presence] = {}
        self._mates: dict[str, Mate] = {}

    def take(self, sender: str, told: Presence, now_s: float, stamp_s: float) -> bool:
        """Note what a mate tells; whether it is news. After a restart its clock may begin anew.

        Args:
            sender: the mate.
            told: with times on its clock.
            now_s: on the listener's.
            stamp_s: on the listener's too, it was told then or later.
        """
        before = self._told.get(sender)
        is_known = sender in self._mates and now_s - self._mates[sender].stamp_s < PRESENT_S
        if before is not None and is_known and told.stamp_s <= before.stamp_s:
            return False
        self._told[sender] = told
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

    def present(self, now_s: float, within_s: float = PRESENT_S) -> tuple[Mate, ...]:
        """Those who were heard of so lately, by name."""
        mates = (self._mates[name] for name in sorted(self._mates))
        return tuple(mate for mate in mates if now_s - mate.stamp_s < within_s)

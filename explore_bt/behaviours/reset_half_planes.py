"""Leaf: forget the half-plane constraint (step 7a of ALGORITHM, ``H ← ∅`` in the pseudo-code)."""

from __future__ import annotations

from explore_bt.exploration import HalfPlaneHistory
from explore_bt.tree import Key, Leaf, Output, Status

__all__ = ["ResetHalfPlanes"]


class ResetHalfPlanes(Leaf):
    """Empties the half-plane history: from now on no half-plane constrains, until the next waypoint."""

    type_key = "reset_half_planes"
    values = (HalfPlaneHistory,)

    history: Output[HalfPlaneHistory] = Output(
        HalfPlaneHistory, default=Key("half_planes"), doc="the history to empty"
    )

    def update(self) -> Status:
        """Write an empty history."""
        count = len(self.recall("history", HalfPlaneHistory()).planes)
        self.history = HalfPlaneHistory()
        self.say(f"{count} half-plane{'' if count == 1 else 's'} forgotten")
        return Status.SUCCESS

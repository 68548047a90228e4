"""Condition: is the exploration getting on? Tells a live-lock from patience."""

from __future__ import annotations

from explore_bt.tree import Input, Leaf, Status
from explore_bt.units import Area

__all__ = ["WatchProgress"]


class WatchProgress(Leaf):
    """FAILURE once the last decisions together have brought no new floor; tick it once a decision.

    The paper's algorithm repeats its reset and reversal for ever where every heading was already taken
    in both directions: this leaf ends such a live-lock and names it.
    """

    type_key = "watch_progress"

    decisions: Input[int] = Input(int, default=12, ge=2, doc="how many decisions may bring nothing")
    min_area: Input[float] = Input(Area, default=0.5, ge=0.0, doc="new floor that counts as progress")

    keeps = ("_history_m2",)

    _history_m2: tuple[float, ...] = ()

    def update(self) -> Status:
        """Compare the known floor with what it was ``decisions`` ticks ago."""
        grid = self.robot.view().grid
        floor_m2 = float(grid.free.sum()) * grid.resolution_m**2
        self._history_m2 = (*self._history_m2, floor_m2)[-self.decisions - 1 :]
        gained_m2 = floor_m2 - self._history_m2[0]
        self.say(f"{floor_m2:.1f} m² known, {gained_m2:+.1f} m² in {len(self._history_m2) - 1} decisions")
        if len(self._history_m2) <= self.decisions or gained_m2 >= self.min_area:
            return Status.SUCCESS
        self.say(
            f"live-lock: {self.decisions} decisions brought {gained_m2:.2f} m² of new floor; "
            "every safe heading from here was already taken"
        )
        return Status.FAILURE

"""When what the safety gate does is worth telling."""

from __future__ import annotations

from explore_bt.interfaces import HeldBy

__all__ = ["GateNews"]

_CALM_S = 1.0


class GateNews:
    """An intervention is told when it begins, when something else holds the robot, and once it is over.

    It is over when commands have passed for a second: beside someone who walks the gate shuts and opens
    several times a second.
    """

    def __init__(self) -> None:
        self._begin_s: float | None = None
        self._last_s = 0.0
        self._held_by = HeldBy.NOTHING

    def of(self, reason: str, held_by: HeldBy, now_s: float) -> str:
        """One line for the log, empty if there is nothing new.

        Args:
            reason: why the gate brakes at this control step; empty if it passes the command on.
            held_by: what kind of reason that is.
            now_s: mission time.
        """
        if reason:
            is_new = self._begin_s is None or held_by is not self._held_by
            self._begin_s = now_s if self._begin_s is None else self._begin_s
            self._last_s, self._held_by = now_s, held_by
            return f"held by {held_by}: {reason}" if is_new else ""
        if self._begin_s is None or now_s - self._last_s < _CALM_S:
            return ""
        lasted_s, self._begin_s = self._last_s - self._begin_s, None
        return f"free again: was held for {lasted_s:.1f} s by {self._held_by}"

    @property
    def is_held(self) -> bool:
        """Whether an intervention goes on."""
        return self._begin_s is not None

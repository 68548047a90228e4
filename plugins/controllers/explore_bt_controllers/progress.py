"""Notices when nothing moves on."""

from __future__ import annotations

import math

__all__ = ["ProgressWatch"]

_ENOUGH = 0.02


class ProgressWatch:
    """Counts the time since what remains to be done last shrank by a little (2 cm, or 0.02 rad)."""

    def __init__(self) -> None:
        self._phase: object = None
        self._best = math.inf
        self.waited_s = 0.0

    def see(self, phase: object, remaining: float, dt_s: float) -> None:
        """Take note of what remains in a phase of the motion; a new phase starts afresh."""
        if phase != self._phase or remaining < self._best - _ENOUGH:
            self._phase, self._best, self.waited_s = phase, remaining, 0.0
        else:
            self.waited_s += dt_s

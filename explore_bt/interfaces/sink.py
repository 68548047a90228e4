"""Contract of sinks: observers of a run."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from explore_bt.interfaces.plugin import Plugin
from explore_bt.interfaces.snapshot import Event, RunInfo, TickSnapshot
from explore_bt.types import Result

__all__ = ["Sink"]


class Sink(Plugin):
    """Sees every tick and every event; never acts.

    Called by the tick thread, outside the control loop. A sink that raises five times in a row is cut
    off and named in the log; the mission goes on.
    """

    kind = "sink"
    wants_past: ClassVar[bool] = False
    """Whether a resumed run shows it what was recorded before the cut, as far as that tells."""

    @abstractmethod
    def open(self, run: RunInfo) -> None:
        """The run begins."""

    @abstractmethod
    def on_tick(self, tick: TickSnapshot) -> None:
        """A tick has ended."""

    def on_event(self, event: Event) -> None:  # many sinks show only ticks
        """Something happened: a recovery, a health change, an intervention of the gate."""

    @abstractmethod
    def close(self, result: Result | None) -> None:
        """The run is over; ``result`` is None if it broke down before it began. Idempotent."""

"""Who stands beside the tick loop: what a debugger needs of it, and what costs nothing without one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explore_bt.runtime.runner import Runner

__all__ = ["Attendant"]


class Attendant:
    """Asked by the runner, in the tick thread; this one lets everything go its way.

    A call may take its time. A simulator's time stands still meanwhile; while real time goes on, the
    robots have to be kept at rest with ``Runner.hold``, control period by control period.
    """

    def begin(self, runner: Runner) -> None:
        """The robots are set up, nothing has moved yet."""

    def on_period(self) -> None:
        """At the rate of the trees: between two ticks, before the first and after the last."""

    def before_tick(self) -> None:
        """The trees are about to be ticked."""

    def on_hold(self) -> None:
        """A control period has passed in which all robots were held."""

    def end(self) -> None:
        """The run is over, or never began; called once."""

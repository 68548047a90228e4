"""Several attendants at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from explore_bt.runtime.attendant import Attendant

if TYPE_CHECKING:
    from explore_bt.runtime.runner import Runner

__all__ = ["Attendants"]


class Attendants(Attendant):
    """Asks each of them, in their order."""

    def __init__(self, members: Sequence[Attendant]) -> None:
        self._members = members

    def begin(self, runner: Runner) -> None:
        """The robots are set up."""
        for member in self._members:
            member.begin(runner)

    def on_period(self) -> None:
        """Between two ticks."""
        for member in self._members:
            member.on_period()

    def before_tick(self) -> None:
        """The trees are about to be ticked."""
        for member in self._members:
            member.before_tick()

    def on_hold(self) -> None:
        """A control period has passed in which all robots were held."""
        for member in self._members:
            member.on_hold()

    def end(self) -> None:
        """The run is over; all of them hear so, whatever one of them raises."""
        try:
            if self._members:
                self._members[0].end()
        finally:
            if self._members:
                Attendants(self._members[1:]).end()

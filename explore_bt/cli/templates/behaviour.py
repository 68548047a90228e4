"""A leaf that waits until the robot has driven a distance."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import hookimpl
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.units import Length


class MyPlugin(Leaf):
    """Succeeds once the robot has driven a distance since the leaf began."""

    type_key = "my_plugin"

    distance: Input[float] = Input(Length, default=1.0, ge=0.0, doc="how far to drive")
    driven: Output[float] = Output(float, default=Key("driven"), doc="metres driven since the leaf began")

    def initialise(self) -> None:
        """A new round begins: count from here."""
        self._begin_m = self.robot.distance_m

    def update(self) -> Status:
        """Compare, and say in words how far it is."""
        driven_m = self.robot.distance_m - self._begin_m
        self.driven = driven_m
        self.say(f"{driven_m:.1f} m of {self.distance:.1f} m")
        return Status.SUCCESS if driven_m >= self.distance else Status.RUNNING


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]

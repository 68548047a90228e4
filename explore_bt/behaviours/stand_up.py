"""Condition with a remedy: can the body drive?"""

from __future__ import annotations

from explore_bt.tree import Input, Leaf, Status
from explore_bt.types import BodyFaultKind
from explore_bt.units import Duration

__all__ = ["StandUp"]


class StandUp(Leaf):
    """SUCCESS while the body can drive; else has it helped up, RUNNING, and FAILURE once patience is over.

    A robot that has fallen holds still by itself; this leaf asks its driver to get it up again. Drivers that
    cannot are waited for: somebody may come.
    """

    type_key = "stand_up"

    keeps = ("helped",)

    patience: Input[float] = Input(Duration, default=30.0, ge=0.0, doc="how long to wait for help")
    times: Input[int] = Input(int, default=3, ge=0, doc="how often in a mission it may be helped up")

    helped: int = 0

    def initialise(self) -> None:
        """The wait begins."""
        self._since_s = self.robot.now_s()
        self._answer = ""

    def update(self) -> Status:
        """Ask the body; ask for help once in every wait."""
        fault = self.robot.pilot.body_fault
        if fault is None:
            self.say("")
            return Status.SUCCESS
        waited_s = self.robot.now_s() - self._since_s
        if fault.kind is BodyFaultKind.FALLEN and not self._answer:
            self._answer = self._ask()
        self.say("; ".join(filter(None, (f"{fault.reason}, for {waited_s:.0f} s", self._answer))))
        return Status.RUNNING if waited_s < self.patience else Status.FAILURE

    def _ask(self) -> str:
        if self.helped >= self.times:
            return f"was helped up {self.helped} times already"
        if not self.robot.pilot.recover_body():
            return "cannot get up by itself"
        self.helped += 1
        return "is helped up"

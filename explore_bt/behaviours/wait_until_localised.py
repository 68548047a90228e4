"""Condition with patience: does the robot know where it is?"""

from __future__ import annotations

from explore_bt.tree import Input, Leaf, Status
from explore_bt.types import Health
from explore_bt.units import Duration

__all__ = ["WaitUntilLocalised"]


class WaitUntilLocalised(Leaf):
    """SUCCESS while SLAM is not lost; else RUNNING, and FAILURE once patience is over.

    The safety gate holds a robot that is lost; this leaf decides how long to hope before giving up.
    """

    type_key = "wait_until_localised"

    patience: Input[float] = Input(Duration, default=20.0, ge=0.0, doc="how long to wait for SLAM to recover")

    def initialise(self) -> None:
        """The wait begins."""
        self._since_s = self.robot.now_s()

    def update(self) -> Status:
        """Ask for the health of the newest estimate."""
        estimate = self.robot.estimate()
        if estimate.health is not Health.LOST:
            self.say("")
            return Status.SUCCESS
        waited_s = self.robot.now_s() - self._since_s
        self.say(f"SLAM is lost for {waited_s:.0f} s: {estimate.reason}")
        return Status.RUNNING if waited_s < self.patience else Status.FAILURE

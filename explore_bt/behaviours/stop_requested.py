"""Condition: has the user raised the stop flag?"""

from __future__ import annotations

from explore_bt.tree import Leaf, Status

__all__ = ["StopRequested"]


class StopRequested(Leaf):
    """SUCCESS once ``stop_exploration`` is raised (the runner then stops the robot within a tick)."""

    type_key = "stop_requested"

    def update(self) -> Status:
        """Ask the flag."""
        is_raised = self.robot.stop_requested
        self.say("the stop flag is raised" if is_raised else "")
        return Status.SUCCESS if is_raised else Status.FAILURE

"""What is recorded where, how often: the table behind the recorder and its documentation."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["PROFILE", "ROBOT_TOPICS", "RUN_TOPICS", "TOPICS", "Topic"]

PROFILE = "x-explore-bt"
"""The MCAP profile by which a recording of ours is known."""


@dataclass(frozen=True, slots=True)
class Topic:
    """One topic; ``<robot>`` in ``pattern`` stands for the robot's name."""

    pattern: str
    schema: str
    rate: str

    def of(self, robot: str) -> str:
        """The topic's name for one robot."""
        return self.pattern.replace("<robot>", robot)


RUN_TOPICS = (
    Topic("/run", "explore_bt.Run", "once, first message"),
    Topic("/events", "foxglove.Log", "as they happen"),
    Topic("/result", "explore_bt.Result", "once, last message"),
)
ROBOT_TOPICS = (
    Topic("/<robot>/tree", "explore_bt.Tree", "on change, key frame every 5 s"),
    Topic("/<robot>/nodes", "explore_bt.NodeTallies", "every 10 s, and at the end"),
    Topic("/<robot>/blackboard", "explore_bt.Blackboard", "on change, key frame every 5 s"),
    Topic("/<robot>/pose", "foxglove.PoseInFrame", "every tick while it moves, else 1 Hz"),
    Topic("/<robot>/truth", "foxglove.PoseInFrame", "with every pose, where the driver knows it"),
    Topic("/<robot>/state", "explore_bt.State", "2 Hz, and on change of health"),
    Topic("/<robot>/scan", "foxglove.LaserScan", "at most 2 Hz"),
    Topic("/<robot>/measured", "explore_bt.Measurements", "all that SLAM was given, once a second"),
    Topic("/<robot>/map", "foxglove.Grid", "on change, at most every 2 s"),
    Topic("/<robot>/path", "foxglove.PosesInFrame", "on change, at most 2 Hz"),
    Topic("/<robot>/waypoint", "foxglove.PoseInFrame", "on change"),
    Topic("/<robot>/visited", "foxglove.PoseInFrame", "one message for each waypoint"),
    Topic("/<robot>/gate", "explore_bt.Gate", "on change"),
    Topic("/<robot>/team", "explore_bt.Team", "on change"),
    Topic("/<robot>/moving", "explore_bt.Moving", "on change, at most 4 Hz"),
    Topic("/<robot>/drawing", "explore_bt.Drawing", "on change: whenever a leaf has looked about"),
)
TOPICS = RUN_TOPICS + ROBOT_TOPICS

"""What an expression can see of one robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from explore_bt.debug.places import Place
from explore_bt.runtime import Robot
from explore_bt.tree import Key, Leaf

__all__ = ["NAMES", "Sight", "known_keys"]

NAMES: Mapping[str, str] = {
    "tick": "number of the tick",
    "time": "mission time, s",
    "coverage": "share of the reachable floor that is mapped; none where nobody knows",
    "distance": "driven so far, m",
    "x": "of the robot, m",
    "y": "of the robot, m",
    "yaw": "heading of the robot, rad",
    "speed": "m/s, as commanded",
    "health": "of SLAM: ok, degraded or lost",
    "gate": "why the safety gate brakes; empty while it does not",
    "robot": "name of the robot",
    "status": "of the node stopped at: success, failure, running or idle",
    "message": "what that node says",
}
"""Name in an expression -> what it is; entries of the blackboard are written ``$entry``."""


class Sight:
    """Looks only at what is asked for.

    Args:
        robot: whose blackboard, pose and figures.
        tick, time_s: when.
        place: the node that is ticked, if one is.
    """

    def __init__(self, robot: Robot, tick: int, time_s: float, place: Place | None = None) -> None:
        self._robot = robot
        self._blackboard = robot.blackboard
        self._looks: Mapping[str, Callable[[], object]] = {
            "tick": lambda: tick,
            "time": lambda: time_s,
            "coverage": lambda: robot.scores.score().coverage,
            "distance": lambda: robot.distance_m,
            "x": lambda: robot.estimate().T_map_base.x,
            "y": lambda: robot.estimate().T_map_base.y,
            "yaw": lambda: robot.estimate().T_map_base.yaw_rad,
            "speed": lambda: robot.pilot.motion.twist.linear_mps,
            "health": lambda: str(robot.estimate().health),
            "gate": lambda: robot.pilot.gate_reason,
            "robot": lambda: robot.name,
            "status": lambda: place.status if place else None,
            "message": lambda: place.node.feedback_message if place else None,
        }

    def name(self, name: str) -> object:
        """One of ``NAMES``."""
        return self._looks[name]()

    def entry(self, key: str) -> object:
        """A blackboard entry; None while nobody has written it."""
        return self._blackboard.get(key)


def known_keys(robot: Robot) -> set[str]:
    """Entries that the robot's tree may write or read, or has written."""
    bound = {
        value.name
        for node in robot.tree.nodes
        if isinstance(node, Leaf)
        for value in node.bindings.values()
        if isinstance(value, Key)
    }
    return bound | set(robot.blackboard)

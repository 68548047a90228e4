"""What a recording says of one moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.recording import RecordedMessage, decode_grid, decode_pose
from explore_bt.types import OccupancyGrid, Pose2

__all__ = ["NODE", "RobotScene", "Scene"]

NODE = ("idle", "")
"""Status and words of a node before it was first ticked."""
_MOST_EVENTS = 3


@dataclass(slots=True)
class RobotScene:
    """One robot as it was last told; everything in the ``map`` frame.

    Attributes:
        nodes: status and words of each node of its tree.
        scan: (N, 2) metres, the returns of the newest scan.
        path, trail: (N, 2) metres: the way ahead, the way driven.
        layers: of the newest drawing.
    """

    tree: Sequence[dict[str, Any]]
    nodes: list[tuple[str, str]]
    pose: Pose2 | None = None
    grid: OccupancyGrid | None = None
    scan: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    path: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    trail: list[tuple[float, float]] = field(default_factory=list)
    layers: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    moving: list[dict[str, Any]] = field(default_factory=list)
    held: str = ""
    state: dict[str, Any] = field(default_factory=dict)


class Scene:
    """Taken forward message by message.

    Attributes:
        events: the newest warnings, errors and recoveries: level and words.
    """

    def __init__(self, trees: dict[str, Sequence[dict[str, Any]]]) -> None:
        self.robots = {name: RobotScene(tree, [NODE] * len(tree)) for name, tree in trees.items()}
        self.events: list[tuple[int, str]] = []

    def take(self, message: RecordedMessage) -> None:
        """Bring the scene up to a message; topics that are not shown are passed over."""
        value = message.value
        if message.topic == "/events":
            if value["level"] > 1:
                self.events = [*self.events, (value["level"], value["message"])][-_MOST_EVENTS:]
            return
        _, _, rest = message.topic.partition("/")
        name, _, topic = rest.rpartition("/")
        robot = self.robots.get(name)
        if robot is not None:
            _take(robot, topic, value)


def _take(robot: RobotScene, topic: str, value: dict[str, Any]) -> None:
    if topic == "pose":
        robot.pose = decode_pose(value["pose"])
        robot.trail.append(robot.pose.xy)
    elif topic == "tree":
        for node in value["nodes"]:
            robot.nodes[node["id"]] = (node["status"], node["message"])
    elif topic == "map":
        robot.grid = decode_grid(value)
    elif topic == "scan":
        robot.scan = _returns(value)
    elif topic == "path":
        places = [(each["position"]["x"], each["position"]["y"]) for each in value["poses"]]
        robot.path = np.array(places, dtype=np.float64).reshape(-1, 2)
    elif topic == "drawing":
        robot.layers = value["layers"]
    elif topic == "moving":
        robot.moving = value["things"]
    elif topic == "gate":
        robot.held = value["reason"]
    elif topic == "state":
        robot.state = value


def _returns(value: dict[str, Any]) -> NDArray[np.float64]:
    ranges = np.array(value["ranges"], dtype=np.float64)  # null is NaN
    angles = np.linspace(value["start_angle"], value["end_angle"], len(ranges))
    is_return = np.isfinite(ranges)
    points = (ranges * np.vstack((np.cos(angles), np.sin(angles)))).T[is_return]
    return np.asarray(decode_pose(value["pose"]).apply(points))

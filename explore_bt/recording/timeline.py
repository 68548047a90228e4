"""What happened when: transitions, curves, the way driven, and everything with a reason in words."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from explore_bt.recording.foxglove import decode_event, decode_pose
from explore_bt.recording.message_log import LoggedMessage, MessageLog
from explore_bt.types import Pose2

__all__ = ["Timeline"]

_AT_A_TIME = 2000
_PARTS = ("tree", "pose", "state", "gate", "visited")
_WORTH_ITS_WORDS = ("success", "failure")


class Timeline:
    """The story of a run as a list of short items that only grows.

    Each item is a JSON array: what it is, the robot (empty where none is meant), mission time in
    seconds, and then

    - ``node``: id, status, reason: a node's status changed, or it decided again for another reason;
    - ``pose``: x, y, yaw_rad in ``map``;
    - ``figures``: coverage (0 to 1, or null), speed in m/s, distance in metres;
    - ``health``: health, reason;
    - ``gate``: whether the safety gate brakes, why;
    - ``visited``: index, reason, x, y;
    - ``event``: level, source, message.
    """

    def __init__(self, log: MessageLog, robots: tuple[str, ...]) -> None:
        self._log = log
        self._robots = robots
        self._topics = ("/events", *(f"/{robot}/{part}" for robot in robots for part in _PARTS))
        self._count = 0
        self._nodes: dict[tuple[str, int], tuple[str, str]] = {}
        self._health: dict[str, tuple[str, str]] = {}
        self.items: list[str] = []

    def catch_up(self) -> None:
        """Take in what has come into the log since the last time."""
        while True:
            messages, self._count = self._log.after(self._topics, self._count, _AT_A_TIME)
            for message in messages:
                self._take(message)
            if len(messages) < _AT_A_TIME:
                return

    def _take(self, message: LoggedMessage) -> None:
        _, _, rest = message.topic.partition("/")
        robot, _, part = rest.rpartition("/")
        stamp_s, value = message.stamp_ns / 1e9, message.value
        match part:
            case "tree":
                self._take_nodes(robot, stamp_s, value)
            case "pose":
                self._take_pose(robot, stamp_s, decode_pose(value["pose"]))
            case "state":
                self._take_figures(robot, stamp_s, value)
            case "gate":
                self._add("gate", robot, stamp_s, value["braking"], value["reason"])
            case "visited":
                at = value["pose"]["position"]
                self._add("visited", robot, stamp_s, value["index"], value["reason"], at["x"], at["y"])
            case _:
                event = decode_event(stamp_s, value, self._robots)
                self._add("event", event.robot, stamp_s, event.level, event.source, event.message)

    def _take_nodes(self, robot: str, stamp_s: float, value: Mapping[str, Any]) -> None:
        for node in value["nodes"]:
            key, now = (robot, node["id"]), (node["status"], node["message"])
            before = self._nodes.get(key)
            if before == now:
                continue
            self._nodes[key] = now
            if before is None or before[0] != now[0] or now[0] in _WORTH_ITS_WORDS:
                self._add("node", robot, stamp_s, node["id"], *now)

    def _take_pose(self, robot: str, stamp_s: float, pose: Pose2) -> None:
        if math.isfinite(pose.x):
            self._add("pose", robot, stamp_s, pose.x, pose.y, round(pose.yaw_rad, 4))

    def _take_figures(self, robot: str, stamp_s: float, value: Mapping[str, Any]) -> None:
        self._add("figures", robot, stamp_s, value["coverage"], value["speed_mps"], value["distance_m"])
        health = (value["health"], value["health_reason"])
        if self._health.get(robot, ("ok", "")) != health:
            self._health[robot] = health
            self._add("health", robot, stamp_s, *health)

    def _add(self, kind: str, robot: str, stamp_s: float, *rest: object) -> None:
        item = [kind, robot, round(stamp_s, 3), *rest]
        self.items.append(json.dumps(item, ensure_ascii=False, separators=(",", ":")))

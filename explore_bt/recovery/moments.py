"""A recording as the sinks of the run saw it: ticks and events, as far as they were recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from explore_bt.interfaces import Event, NodeState, RobotSnapshot, TickSnapshot
from explore_bt.recording import RecordedMessage, Recording, decode_event, decode_grid, decode_pose
from explore_bt.recovery.messages import motion_of, score_of, waypoint_of
from explore_bt.types import Estimate, Health, MotionState, OccupancyGrid, Pose2, Score, Waypoint

__all__ = ["moments_of"]


def moments_of(recording: Recording) -> Iterator[TickSnapshot | Event]:
    """Every tick that has left a message, and every event, in their order.

    What was recorded now and then stands as it was recorded last: maps are up to two seconds old. Scans,
    paths and the blackboard, but for the waypoints under ``visited``, are left out.
    """
    robots = {name: _Robot(name, nodes) for name, nodes in recording.info.get("trees", {}).items()}
    index, stamp_s = 0, 0.0
    is_new = False
    for message in recording.messages():
        if is_new and message.stamp_s > stamp_s:
            yield _tick(index, stamp_s, robots)
            index, is_new = index + 1, False
        stamp_s = max(stamp_s, message.stamp_s)
        if message.topic == "/events":
            yield decode_event(message.stamp_s, message.value, robots)
            continue
        name, _, topic = message.topic[1:].partition("/")
        if name in robots:
            is_new |= robots[name].take(topic, message)
    if is_new:
        yield _tick(index, stamp_s, robots)


def _tick(index: int, stamp_s: float, robots: Mapping[str, _Robot]) -> TickSnapshot:
    return TickSnapshot(index, stamp_s, tuple(robot.snapshot(stamp_s) for robot in robots.values()))


class _Robot:
    """One robot as it stands at the present message."""

    def __init__(self, name: str, nodes: list[Any]) -> None:
        self._name = name
        self._nodes = [NodeState("idle", "")] * len(nodes)
        self._pose = Pose2.identity()
        self._true_pose: Pose2 | None = None
        self._health = (Health.OK, "")
        self._score, self._motion = Score(), MotionState()
        self._grid = OccupancyGrid(np.empty((0, 0), dtype=np.int8), 0.05, (0.0, 0.0))
        self._gate_reason = ""
        self._visited: dict[int, Waypoint] = {}
        self._board: Mapping[str, object] = {}
        self._takes: Mapping[str, Callable[[Mapping[str, Any]], None]] = {
            "tree": self._tree,
            "pose": self._at,
            "truth": self._truly_at,
            "state": self._state,
            "map": self._map,
            "gate": self._gate,
            "visited": self._visit,
        }

    def take(self, topic: str, message: RecordedMessage) -> bool:
        """Stand as a message says; whether it is one of those that snapshots tell of."""
        if topic not in self._takes:
            return False
        self._takes[topic](message.value)
        return True

    def snapshot(self, stamp_s: float) -> RobotSnapshot:
        """As a sink would have been shown it."""
        health, reason = self._health
        return RobotSnapshot(
            robot=self._name,
            estimate=Estimate(stamp_s, self._pose, health=health, reason=reason),
            grid=self._grid,
            scan=None,
            path=None,
            motion=self._motion,
            gate_reason=self._gate_reason,
            nodes=tuple(self._nodes),
            blackboard=self._board,
            score=self._score,
            true_pose=self._true_pose,
        )

    def _tree(self, value: Mapping[str, Any]) -> None:
        for node in value["nodes"]:
            state = NodeState(str(node["status"]), str(node["message"]))
            if self._nodes[node["id"]] != state:  # the same object as long as it stands
                self._nodes[node["id"]] = state

    def _at(self, value: Mapping[str, Any]) -> None:
        self._pose = decode_pose(value["pose"])

    def _truly_at(self, value: Mapping[str, Any]) -> None:
        self._true_pose = decode_pose(value["pose"])

    def _state(self, value: Mapping[str, Any]) -> None:
        self._score, self._motion = score_of(value), motion_of(value)
        self._health = (Health(value["health"]), str(value["health_reason"]))

    def _map(self, value: Mapping[str, Any]) -> None:
        self._grid = decode_grid(value)

    def _gate(self, value: Mapping[str, Any]) -> None:
        self._gate_reason = str(value["reason"])

    def _visit(self, value: Mapping[str, Any]) -> None:
        index = int(value.get("index", len(self._visited)))
        if index == 0:
            self._visited.clear()
        self._visited[index] = waypoint_of(value)
        self._board = {"visited": tuple(self._visited.values())}

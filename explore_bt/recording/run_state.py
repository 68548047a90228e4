"""Where a run was at a moment: what the key frame before it and the differences since add up to."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from explore_bt.recording.foxglove import time_json
from explore_bt.recording.message_log import LoggedMessage, MessageLog

__all__ = ["FOLLOWED_TOPICS", "NodeNow", "RobotState", "followed_topics", "state_at"]

FOLLOWED_TOPICS = (
    "pose",
    "truth",
    "state",
    "scan",
    "map",
    "path",
    "waypoint",
    "gate",
    "team",
    "moving",
    "drawing",
)
"""Topics of a robot of which the newest message says all there is to say."""

_FIRST_REACH_NS = 6_000_000_000  # the recorder writes a key frame every five seconds


@dataclass(frozen=True, slots=True)
class NodeNow:
    """A node: its status, and its last reason in words."""

    status: str
    message: str


@dataclass(frozen=True, slots=True)
class RobotState:
    """One robot at a moment.

    Attributes:
        tick: of the tree, the last in which something changed; -1 before the first.
        nodes: by id.
        blackboard: as ``to_json`` tells values.
        visited: the messages of the waypoints so far, by their ``index``.
        newest: last part of the topic (``FOLLOWED_TOPICS``) -> newest message.
    """

    tick: int = -1
    nodes: Mapping[int, NodeNow] = field(default_factory=dict)
    blackboard: Mapping[str, Any] = field(default_factory=dict)
    visited: tuple[Mapping[str, Any], ...] = ()
    newest: Mapping[str, LoggedMessage] = field(default_factory=dict)

    def messages(self, robot: str, at_ns: int) -> Iterator[LoggedMessage]:
        """Messages from which a reader of the recording's topics arrives at this state."""
        head = f'{{"timestamp":{time_json(at_ns)},'
        nodes = [{"id": id_, "status": n.status, "message": n.message} for id_, n in self.nodes.items()]
        tree = f'"tick":{self.tick},"key_frame":true,"nodes":{_json(nodes)}}}'
        board = f'"key_frame":true,"set":{_json(self.blackboard)},"removed":[]}}'
        yield LoggedMessage(f"/{robot}/tree", at_ns, head + tree)
        yield LoggedMessage(f"/{robot}/blackboard", at_ns, head + board)
        for visited in self.visited:
            yield LoggedMessage(f"/{robot}/visited", at_ns, _json(visited))
        yield from self.newest.values()


def followed_topics(robot: str) -> tuple[str, ...]:
    """All topics that make up a robot's state."""
    return tuple(f"/{robot}/{name}" for name in ("tree", "blackboard", "visited", *FOLLOWED_TOPICS))


def state_at(log: MessageLog, robot: str, at_ns: int) -> RobotState:
    """One robot as it was at ``at_ns`` of mission time, nanoseconds.

    What it costs does not grow with the run: a key frame, the differences after it, and the newest
    message of every other topic (of the waypoints, all).
    """
    tick, nodes = -1, dict[int, NodeNow]()
    for value in _since_key_frame(log, f"/{robot}/tree", at_ns):
        tick = value["tick"]
        nodes |= {node["id"]: NodeNow(node["status"], node["message"]) for node in value["nodes"]}
    board: dict[str, Any] = {}
    for value in _since_key_frame(log, f"/{robot}/blackboard", at_ns):
        board |= value["set"]
        for name in value["removed"]:
            board.pop(name, None)
    newest = {name: log.last(f"/{robot}/{name}", at_ns) for name in FOLLOWED_TOPICS}
    return RobotState(
        tick,
        nodes,
        board,
        _visited(log, f"/{robot}/visited", at_ns),
        {name: message for name, message in newest.items() if message is not None},
    )


def _since_key_frame(log: MessageLog, topic: str, at_ns: int) -> list[dict[str, Any]]:
    reach_ns = _FIRST_REACH_NS
    while True:
        values = [message.value for message in log.between([topic], at_ns - reach_ns, at_ns)]
        for index in range(len(values) - 1, -1, -1):
            if values[index]["key_frame"]:
                return values[index:]
        if reach_ns > at_ns:
            return values
        reach_ns *= 4


def _visited(log: MessageLog, topic: str, at_ns: int) -> tuple[Mapping[str, Any], ...]:
    """A waypoint takes the place of its index; those after it were forgotten by then."""
    visited: list[Mapping[str, Any]] = []
    for message in log.between([topic], -1, at_ns):
        value = message.value
        visited[value["index"] :] = [value]
    return tuple(visited)


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))

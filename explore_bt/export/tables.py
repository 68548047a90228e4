"""A recording as tables: what spreadsheets, pandas and databases want."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from explore_bt.export.table import Cell, Table
from explore_bt.recording import RecordedMessage, Recording, decode_event, decode_pose

__all__ = ["TABLES", "read_tables"]

_WORDS = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}

TABLES: Mapping[str, tuple[str, ...]] = {
    "poses": ("time_s", "robot", "x_m", "y_m", "yaw_rad"),
    "truth": ("time_s", "robot", "x_m", "y_m", "yaw_rad"),
    "states": ("time_s", "robot", "distance_m", "coverage", "speed_mps", "turn_rate_rps", "health"),
    "events": ("time_s", "robot", "level", "source", "message"),
    "gate": ("time_s", "robot", "braking", "held_by", "reason"),
    "transitions": ("time_s", "robot", "tick", "path", "type", "status", "message"),
    "blackboard": ("time_s", "robot", "entry", "value"),
    "nodes": ("robot", "path", "type", "ticks", "successes", "failures", "cut_off", "running_s", "longest_s"),
}
"""Table -> its first columns; ``states`` has one for every further figure of the recording."""


def read_tables(recording: Recording) -> dict[str, Table]:
    """All tables of ``TABLES``; time is mission time, places are in the ``map`` frame."""
    reader = _Reader(recording)
    for message in recording.messages(reader.topics):
        reader.take(message)
    reader.finish()
    return reader.tables


class _Reader:
    def __init__(self, recording: Recording) -> None:
        self.tables = {name: Table(*columns) for name, columns in TABLES.items()}
        self._trees: dict[str, list[dict[str, Any]]] = recording.info.get("trees", {})
        self._states: dict[tuple[str, int], tuple[str, str]] = {}
        self._entries: dict[tuple[str, str], str] = {}
        self._counts: dict[str, list[dict[str, Cell]]] = {}
        self._takers: dict[str, Callable[[float, str, dict[str, Any]], None]] = {
            "pose": self._pose,
            "truth": self._truth,
            "state": self._state,
            "gate": self._gate,
            "tree": self._tree,
            "blackboard": self._blackboard,
            "nodes": self._nodes,
        }
        robots = (f"/{robot}/{topic}" for robot in self._trees for topic in self._takers)
        self.topics = frozenset(("/events", *robots))

    def take(self, message: RecordedMessage) -> None:
        """Add what a message tells."""
        if message.topic == "/events":
            self._event(message)
            return
        _, robot, topic = message.topic.split("/")
        self._takers[topic](round(message.stamp_s, 9), robot, message.value)

    def finish(self) -> None:
        """Add the last counts."""
        for robot, counts in self._counts.items():
            for node in counts:
                named = self._trees[robot][int(node.pop("id") or 0)]
                known: dict[str, Cell] = {"robot": robot, "path": named["path"], "type": named["type"]}
                self.tables["nodes"].add(known | node)

    def _add(self, table: str, stamp_s: float, robot: str, row: Mapping[str, Cell]) -> None:
        self.tables[table].add({"time_s": stamp_s, "robot": robot, **row})

    def _pose(self, stamp_s: float, robot: str, value: dict[str, Any]) -> None:
        self._add("poses", stamp_s, robot, _pose(value))

    def _truth(self, stamp_s: float, robot: str, value: dict[str, Any]) -> None:
        self._add("truth", stamp_s, robot, _pose(value))

    def _state(self, stamp_s: float, robot: str, value: dict[str, Any]) -> None:
        figures = {name: each for name, each in value.items() if name not in ("timestamp", "left")}
        left = {f"left_{name}": each for name, each in value.get("left", {}).items()}
        self._add("states", stamp_s, robot, {**figures, **left})

    def _gate(self, stamp_s: float, robot: str, value: dict[str, Any]) -> None:
        self._add("gate", stamp_s, robot, {name: each for name, each in value.items() if name != "timestamp"})

    def _nodes(self, _: float, robot: str, value: dict[str, Any]) -> None:
        self._counts[robot] = value["nodes"]

    def _tree(self, stamp_s: float, robot: str, value: dict[str, Any]) -> None:
        for node in value["nodes"]:
            state = (node["status"], node["message"])
            if self._states.get((robot, node["id"])) == state:
                continue  # a key frame says again what is known
            self._states[robot, node["id"]] = state
            named = self._trees[robot][node["id"]]
            row = {"tick": value["tick"], "path": named["path"], "type": named["type"]}
            self._add("transitions", stamp_s, robot, {**row, "status": state[0], "message": state[1]})

    def _blackboard(self, stamp_s: float, robot: str, value: dict[str, Any]) -> None:
        for key, entry in value["set"].items():
            text = repr(entry)
            if self._entries.get((robot, key)) != text:
                self._entries[robot, key] = text
                for name, number in _numbers(key, entry):
                    self._add("blackboard", stamp_s, robot, {"entry": name, "value": number})

    def _event(self, message: RecordedMessage) -> None:
        event = decode_event(message.stamp_s, message.value, self._trees)
        row = {"level": event.level, "source": event.source, "message": event.message}
        self._add("events", round(message.stamp_s, 9), event.robot, row)


def _pose(value: dict[str, Any]) -> dict[str, Cell]:
    pose = decode_pose(value["pose"])
    if math.isnan(pose.x):
        return {}
    return {"x_m": pose.x, "y_m": pose.y, "yaw_rad": round(pose.yaw_rad, 6)}


def _numbers(name: str, value: object) -> Iterator[tuple[str, float]]:
    """Every number in an entry, ``goal.pose.x``; true and false are 1 and 0."""
    if isinstance(value, bool | int | float):
        yield name, float(value)
    elif isinstance(value, str) and value in _WORDS:
        yield name, _WORDS[value]
    elif isinstance(value, dict):
        for key, each in value.items():
            yield from _numbers(f"{name}.{key}", each)
    elif isinstance(value, list):
        for index, each in enumerate(value):
            yield from _numbers(f"{name}.{index}", each)

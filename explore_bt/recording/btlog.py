"""A recording as ``.btlog``, the file of BehaviorTree.CPP's ``FileLogger2``, which Groot2 plays back.

Layout, little-endian: the magic text, a version byte, the XML's length (int32) and text, the time of the
first record in microseconds (int64), then nine bytes a transition: microseconds since then (6), the node's
number (2) and its status (1).
"""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping
from typing import Any

from explore_bt.errors import UserError
from explore_bt.interfaces import NodeInfo
from explore_bt.mission.btcpp import live_tree_xml, uid_of
from explore_bt.recording.reader import Recording

__all__ = ["STATUS_BYTES", "btlog", "transition_record"]

STATUS_BYTES: Mapping[str, int] = {"idle": 0, "running": 1, "success": 2, "failure": 3}
"""Status -> BehaviorTree.CPP's number for it."""

_MAGIC = b"BTCPP4-FileLogger2"
_VERSION = 1
_MOST_NODES = 2**16 - 1
_FIELDS = ("id", "path", "name", "type", "parent", "place")
_TIMEOUT, _RETRY = re.compile(r"timeout ([\d.e+-]+) s"), re.compile(r"retry (\d+)")


def btlog(recording: Recording, robot: str = "") -> bytes:
    """The tree of one robot and every change of status, in mission time.

    Args:
        recording: whole or cut off.
        robot: whose tree; the first one's by default.

    Raises:
        UserError: no such robot, or a tree too large for the format.
    """
    name = robot or next(iter(recording.robots), "")
    if name not in recording.robots:
        known = ", ".join(recording.robots) or "none"
        raise UserError(f'{recording.path}: there is no robot "{name}"; its robots: {known}')
    records = recording.info["trees"][name]
    nodes = [NodeInfo(**{field: record[field] for field in _FIELDS}) for record in records]
    if len(nodes) > _MOST_NODES:
        raise UserError(f"{recording.path}: {len(nodes)} nodes; a .btlog holds {_MOST_NODES} at most")
    attributes = {node.path: _attributes(node, record) for node, record in zip(nodes, records, strict=True)}
    xml = live_tree_xml(nodes, attributes).encode()
    head = _MAGIC + struct.pack("<Bi", _VERSION, len(xml)) + xml + struct.pack("<q", 0)
    return head + b"".join(_transitions(recording, name, nodes))


def _attributes(node: NodeInfo, record: Mapping[str, Any]) -> dict[str, str]:
    """What the record tells of a node's ports, and of the time limits and attempts of modifiers."""
    ports = {port["name"]: port["bound"] for port in record.get("ports", ())}
    found = {port: f"{{{text[1:]}}}" if text.startswith("$") else text for port, text in ports.items()}
    if node.type == "timeout" and (limit := _TIMEOUT.fullmatch(node.name)):
        found["msec"] = str(max(1, round(1000 * float(limit[1]))))
    if node.type == "retry" and (retries := _RETRY.fullmatch(node.name)):
        found["num_attempts"] = str(int(retries[1]) + 1)
    return found


def transition_record(stamp_s: float, uid: int, status: str) -> bytes:
    """One change of status, as in logs and in what a Groot2 server recorded."""
    return struct.pack("<Q", max(0, round(stamp_s * 1e6)))[:6] + struct.pack("<HB", uid, STATUS_BYTES[status])


def _transitions(recording: Recording, robot: str, nodes: list[NodeInfo]) -> list[bytes]:
    """Changes only; within a tick parents come before their children, as the recording has them."""
    status = ["idle"] * len(nodes)
    records = []
    for message in recording.messages(f"/{robot}/tree"):
        for state in message.value["nodes"]:
            node = nodes[state["id"]]
            if status[node.id] != state["status"]:
                status[node.id] = state["status"]
                records.append(transition_record(message.stamp_s, uid_of(node), state["status"]))
    return records

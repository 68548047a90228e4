"""Where a tree stands, kept for another process to go on from."""

from __future__ import annotations

from collections.abc import Mapping

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree.control import ControlNode
from explore_bt.tree.leaf import Leaf

__all__ = ["TreeMemory", "restore_tree", "tree_memory"]

TreeMemory = Mapping[str, Mapping[str, object]]
"""Path of a node -> what it remembers; nodes without anything to remember are left out."""


def tree_memory(nodes: Mapping[str, Behaviour]) -> TreeMemory:
    """What the nodes remember: control nodes while they run, leaves always what they declare to keep.

    Args:
        nodes: by their paths.
    """
    found: dict[str, Mapping[str, object]] = {}
    for path, node in nodes.items():
        if isinstance(node, ControlNode) and node.status is Status.RUNNING:
            found[path] = node.memory()
        elif isinstance(node, Leaf) and (kept := node.memory()):
            found[path] = kept
    return found


def restore_tree(nodes: Mapping[str, Behaviour], memory: TreeMemory) -> None:
    """Have a tree that was never ticked go on where another one of the same mission stood.

    Control nodes go on in their rounds, with the same children; leaves that were running begin again.
    """
    for path, kept in memory.items():
        node = nodes.get(path)
        if isinstance(node, ControlNode | Leaf):
            node.restore(kept)

"""What of a robot a checkpoint keeps, beside the map of its SLAM."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from py_trees.behaviour import Behaviour

from explore_bt.checkpoint import RobotMemory
from explore_bt.mission import BuiltTree
from explore_bt.tree import Blackboard, TreeMemory, restore_tree, tree_memory
from explore_bt.types import Measurement, Pose2

__all__ = ["Remembering", "RobotKeeping", "sort_of"]


class Remembering(Protocol):
    """A part of a robot that a resumed run finds as it was."""

    def memory(self) -> Mapping[str, object]:
        """What it has to remember; values that a ``Codec`` takes and nobody changes."""

    def restore(self, memory: Mapping[str, object]) -> None:
        """Stand as it stood when ``memory`` was taken."""


class RobotKeeping:
    """Gathers a robot's memory, and gives it back.

    Args:
        tree: the robot's.
        blackboard: the same.
        parts: by the names under which checkpoints know them.
    """

    def __init__(self, tree: BuiltTree, blackboard: Blackboard, parts: Mapping[str, Remembering]) -> None:
        self._nodes: Mapping[str, Behaviour] = {
            info.path: node for info, node in zip(tree.infos, tree.nodes, strict=True)
        }
        self._blackboard = blackboard
        self._parts = parts
        self._heard: dict[str, float] = {}
        self._stood: TreeMemory | None = None

    def hear(self, measurement: Measurement) -> None:
        """SLAM is given a measurement."""
        self._heard[sort_of(measurement)] = measurement.stamp_s

    def rest(self) -> None:
        """The tree is about to be cut off: a resumed run goes on where it stands now."""
        self._stood = tree_memory(self._nodes)

    def memory(self, home: Pose2, pose: Pose2, true_pose: Pose2 | None, poses_before: int) -> RobotMemory:
        """All that another process needs to go on, but SLAM's map; every value is immutable."""
        return RobotMemory(
            home=home,
            pose=pose,
            true_pose=true_pose,
            poses_before=poses_before,
            heard=dict(self._heard),
            blackboard=dict(self._blackboard),
            nodes=tree_memory(self._nodes) if self._stood is None else self._stood,
            parts={name: part.memory() for name, part in self._parts.items()},
        )

    def restore(self, memory: RobotMemory) -> None:
        """Go on from there."""
        for name, part in self._parts.items():
            if name in memory.parts:  # a checkpoint of an earlier version knows fewer
                part.restore(memory.parts[name])
        for key, value in memory.blackboard.items():
            self._blackboard.write(key, value)
        restore_tree(self._nodes, memory.nodes)
        self._heard = dict(memory.heard)


def sort_of(measurement: Measurement) -> str:
    """Kind and frame: what one sensor's measurements have in common."""
    return f"{type(measurement).__name__} {measurement.frame}"

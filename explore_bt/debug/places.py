"""The nodes of all robots' trees, found by their paths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from py_trees.behaviour import Behaviour

from explore_bt.errors import DebugError
from explore_bt.interfaces import NodeInfo
from explore_bt.mission.words import did_you_mean
from explore_bt.runtime import Robot
from explore_bt.tree import status_word

__all__ = ["Place", "Places"]

LONGEST = 2000


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A node of one robot's tree."""

    robot: Robot
    node: Behaviour
    info: NodeInfo

    def __str__(self) -> str:
        return self.info.path

    @property
    def status(self) -> str:
        """As it stands, in words."""
        return status_word(self.node.status)


class Places:
    """All nodes of a run."""

    def __init__(self, robots: Sequence[Robot]) -> None:
        self.robots = {robot.name: robot for robot in robots}
        self._all = tuple(
            Place(robot, node, info)
            for robot in robots
            for node, info in zip(robot.tree.nodes, robot.tree.infos, strict=True)
        )
        self._by_node = {id(place.node): place for place in self._all}

    def __iter__(self) -> Iterator[Place]:
        return iter(self._all)

    def of(self, node: Behaviour) -> Place:
        """The place of a node."""
        return self._by_node[id(node)]

    def robot(self, name: str) -> Robot:
        """The robot of that name.

        Raises:
            DebugError: there is none.
        """
        if name not in self.robots:
            raise DebugError(f'there is no robot "{name}"; {did_you_mean(name, self.robots, "robots")}')
        return self.robots[name]

    def matching(self, path: str, robot: str = "*") -> tuple[Place, ...]:
        """The nodes that a pattern means, as ``Breakpoint.path`` explains it.

        Raises:
            DebugError: none.
        """
        if len(path) + len(robot) > LONGEST:
            raise DebugError(f"a path of {len(path)} characters; at most {LONGEST}")
        names = {name for name in self.robots if fnmatchcase(name, robot)}
        if not names:
            self.robot(robot)
        found = tuple(
            place for place in self._all if place.robot.name in names and _is_meant(path, place.info.path)
        )
        if not found:
            paths = {place.info.path for place in self._all if place.robot.name in names}
            ends = {each.rpartition("/")[2] for each in paths}
            known = paths if "/" in path else ends
            raise DebugError(f'no node is called "{path}"; {did_you_mean(path, known, "nodes")}')
        return found


def _is_meant(pattern: str, path: str) -> bool:
    whole = f"/{path}"  # so that a pattern begins where a name begins
    return whole.endswith(f"/{pattern}") or fnmatchcase(whole, f"*/{pattern}")

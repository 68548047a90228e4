"""Nodes that the debugger answers for, to see what the tree makes of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from explore_bt.debug.places import Place, Places
from explore_bt.debug.state import Forced
from explore_bt.errors import DebugError
from explore_bt.tree import Leaf, Status

__all__ = ["ForcedAnswers"]

_ANSWERS = {"success": Status.SUCCESS, "failure": Status.FAILURE}


class ForcedAnswers:
    """Which nodes, and with what; the node says so itself, so that every record shows it."""

    def __init__(self, places: Places, tell: Callable[[str, str], None]) -> None:
        """``tell`` takes what is worth a line in the record, and the robot it is about."""
        self._places = places
        self._tell = tell
        self._forced: dict[int, Forced] = {}
        self._together: dict[int, frozenset[int]] = {}
        self._spoken: set[int] = set()

    def __bool__(self) -> bool:
        return bool(self._forced or self._spoken)

    @property
    def states(self) -> tuple[Forced, ...]:
        """All nodes that will be answered for."""
        return tuple(self._forced.values())

    def force(self, path: str, robot: str, status: str, *, once: bool) -> int:
        """Answer for the nodes of a pattern; how many these are.

        Raises:
            DebugError: no such node, or an answer that a node cannot be given.
        """
        if status not in _ANSWERS:
            raise DebugError(f'a node cannot be forced to "{status}"; say success or failure')
        places = self._places.matching(path, robot)
        meant = frozenset(id(place.node) for place in places)
        for place in places:
            self._forced[id(place.node)] = Forced(place.robot.name, place.info.path, status, bool(once))
            self._together[id(place.node)] = meant
        self._tell_each(places, f"forced to {status.upper()} {'once' if once else 'until released'}")
        return len(places)

    def release(self, path: str, robot: str) -> int:
        """Let the nodes of a pattern be ticked again; how many of them were forced."""
        found = tuple(place for place in self._places.matching(path, robot) if id(place.node) in self._forced)
        for place in found:
            del self._forced[id(place.node)]
        self._tell_each(found, "forced no more")
        return len(found)

    def _tell_each(self, places: Sequence[Place], what: str) -> None:
        """One event a robot, however many nodes."""
        for robot in dict.fromkeys(place.robot.name for place in places):
            own = [str(place) for place in places if place.robot.name == robot]
            self._tell(f"{own[0]} is {what}" if len(own) == 1 else f"{len(own)} nodes are {what}", robot)

    def answer(self, place: Place) -> Status | None:
        """What to answer in the node's place, if anything."""
        node = place.node
        forced = self._forced.get(id(node))
        if forced is None:
            if id(node) in self._spoken:  # what it says from now on is its own
                self._spoken.discard(id(node))
                node.feedback_message = ""
            return None
        node.feedback_message = f"forced to {forced.status.upper()} by the debugger"
        self._spoken.add(id(node))
        if not forced.answers:
            self._tell(f"{place}: {node.feedback_message}", place.robot.name)
        if forced.once:
            meant = self._together[id(node)]
            for each in meant:
                if self._together[each] is meant:  # it was not forced anew since
                    self._forced.pop(each, None)
        else:
            self._forced[id(node)] = replace(forced, answers=forced.answers + 1)
        if forced.status == "failure" and isinstance(node, Leaf):
            _write_codes(node)
        return _ANSWERS[forced.status]


def _write_codes(leaf: Leaf) -> None:
    """Texts a failing leaf tells its tree (``failure: held``) read ``forced``: recoveries ask for them."""
    for name, port in leaf.outputs.items():
        if port.type is str:
            setattr(leaf, name, "forced")

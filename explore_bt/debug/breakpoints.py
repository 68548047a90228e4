"""The breakpoints that are set, and whether one of them is hit."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from py_trees.behaviour import Behaviour

from explore_bt.debug.breakpoint import STATUSES, Breakpoint, Moment
from explore_bt.debug.expression import Expression, ExpressionError
from explore_bt.debug.places import Place, Places
from explore_bt.debug.sight import Sight
from explore_bt.debug.state import BreakpointState
from explore_bt.errors import DebugError
from explore_bt.mission.words import did_you_mean
from explore_bt.tree import Status, status_word

__all__ = ["Breakpoints"]

MOST = 1000
_STATUSES = {status_word(status): status for status in Status}


@dataclass(slots=True, eq=False)
class _Set:
    number: int
    breakpoint: Breakpoint
    condition: Expression | None
    places: tuple[Place, ...]
    status: Status | None
    hits: int = 0
    fault: str = ""

    @property
    def state(self) -> BreakpointState:
        return BreakpointState(self.number, self.breakpoint, len(self.places), self.hits, self.fault)


class Breakpoints:
    """Looked up at every node: by node and moment, so that those elsewhere cost nothing.

    Args:
        places: where they can be.
        now: tick index and mission time, for conditions.

    Attributes:
        have_news: whether one was hit, or failed, since ``states`` was asked.
    """

    def __init__(self, places: Places, now: Callable[[], tuple[int, float]]) -> None:
        self._places = places
        self._now = now
        self._next = 1
        self._set: dict[int, _Set] = {}
        self._at: dict[Moment, dict[int, list[_Set]]] = {moment: {} for moment in Moment}
        self.have_news = False

    def __bool__(self) -> bool:
        return any(self._at.values())

    def states(self) -> tuple[BreakpointState, ...]:
        """All that are set, in their order; no news after that."""
        self.have_news = False
        return tuple(each.state for each in self._set.values())

    def add(self, wanted: Breakpoint) -> int:
        """Its number.

        Raises:
            DebugError: no such node or status, or a condition that cannot be understood.
        """
        _check(wanted)
        if len(self._set) >= MOST:
            raise DebugError(f"{MOST} breakpoints are set; delete some first")
        places = self._places.matching(wanted.path, wanted.robot)
        condition = Expression(wanted.condition) if wanted.condition else None
        if condition is not None:
            for robot in {id(place.robot): place.robot for place in places}.values():
                condition.check(robot)
        number, self._next = self._next, self._next + 1
        self._set[number] = _Set(number, wanted, condition, places, _STATUSES.get(wanted.status))
        self._sort()
        return number

    def remove(self, number: int) -> None:
        """Forget one; 0 forgets all."""
        if number == 0:
            self._set.clear()
        else:
            del self._set[self._known(number).number]
        self._sort()

    def enable(self, number: int, enabled: bool) -> None:
        """Let one stop the run or not."""
        found = self._known(number)
        found.breakpoint = replace(found.breakpoint, enabled=bool(enabled))
        self._sort()

    def hit(self, node: Behaviour, moment: Moment) -> str:
        """Why to stop at a node, in words; empty if there is no reason to."""
        watched = self._at[moment].get(id(node))
        if watched is None or all(each.status not in (None, node.status) for each in watched):
            return ""
        place, stops = self._places.of(node), ""
        for each in list(watched):
            if self._holds(each, place):
                each.hits += 1
                self.have_news = True
                if each.hits > each.breakpoint.ignore:
                    stops = stops or f"breakpoint {each.number}: {_told(place, moment)}"
                    if each.breakpoint.once:
                        self.remove(each.number)
        return stops

    def _holds(self, each: _Set, place: Place) -> bool:
        if each.status not in (None, place.node.status):
            return False
        if each.condition is None:
            return True
        tick, time_s = self._now()
        try:
            held = each.condition.holds(Sight(place.robot, tick, time_s, place))
        except ExpressionError as fault:
            self.have_news |= each.fault != str(fault)
            each.fault = str(fault)
            return False
        each.fault = ""
        return held

    def _known(self, number: int) -> _Set:
        if number not in self._set:
            numbers = ", ".join(map(str, self._set)) or "none is set"
            raise DebugError(f"there is no breakpoint {number}; known: {numbers}")
        return self._set[number]

    def _sort(self) -> None:
        for watched in self._at.values():
            watched.clear()
        for each in self._set.values():
            if each.breakpoint.enabled:
                for place in each.places:
                    self._at[each.breakpoint.moment].setdefault(id(place.node), []).append(each)


def _told(place: Place, moment: Moment) -> str:
    if moment is Moment.BEFORE:
        return f"before {place} ({place.status.upper()})"
    words = place.node.feedback_message
    return f"{place} gave {place.status.upper()}{f' ({words})' if words else ''}"


def _check(wanted: Breakpoint) -> None:
    """Whatever a client sent over a wire: nothing of it may fail later, in the middle of a tick."""
    texts = (wanted.path, wanted.status, wanted.condition, wanted.robot)
    if not all(isinstance(text, str) for text in texts):
        raise DebugError("path, status, condition and robot of a breakpoint are texts")
    if not isinstance(wanted.moment, Moment):
        raise DebugError(f'there is no moment "{wanted.moment}"; known: before, after')
    status = wanted.status
    if status and status not in STATUSES:
        raise DebugError(f'there is no status "{status}"; {did_you_mean(status, STATUSES)}')
    if status == "idle" and wanted.moment is Moment.AFTER:
        raise DebugError("no node is idle after its tick; say before, or another status")
    ignore = wanted.ignore
    if not isinstance(ignore, int) or not 0 <= ignore < math.inf:
        raise DebugError(f"a breakpoint ignores a whole number of hits from 0 on, not {ignore!r}")

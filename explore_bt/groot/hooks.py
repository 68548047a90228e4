"""The hooks of one robot's tree, carried out by the debugger's session."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from concurrent.futures import TimeoutError as NotYet
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from explore_bt.debug import (
    AddBreakpoint,
    Breakpoint,
    Command,
    DebugSession,
    DebugState,
    Force,
    Moment,
    Release,
    RemoveBreakpoint,
    Resume,
)
from explore_bt.errors import DebugError
from explore_bt.groot.hook import ANSWERS, Hook, Mode, Position, number
from explore_bt.groot.protocol import GrootError

__all__ = ["Hooks"]

T = TypeVar("T")

_PATIENCE_S = 2.0
"""How long a client waits for the tick thread, which looks at commands once a control period."""
_MOMENTS = {Position.PRE: Moment.BEFORE, Position.POST: Moment.AFTER}
_POSITIONS = {str(moment): position for position, moment in _MOMENTS.items()}
_MOST_HOOKS = 500


@dataclass(frozen=True, slots=True)
class _Set:
    """A hook and the number of its breakpoint in the session; None while it has none."""

    hook: Hook
    breakpoint: int | None


class Hooks:
    """Sets, unlocks and removes hooks; called by the server's thread alone.

    Args:
        session: of the run.
        robot: whose tree.
        paths: number of a node -> its path.
    """

    def __init__(self, session: DebugSession, robot: str, paths: Mapping[int, str]) -> None:
        self._session = session
        self._robot = robot
        self._paths = paths
        self._uids = {path: uid for uid, path in paths.items()}
        self._hooks: dict[tuple[int, Position], _Set] = {}

    def __len__(self) -> int:
        return len(self._hooks)

    def insert(self, data: Any) -> None:
        """Set one hook or a list of them; one at the same place is replaced."""
        for hook in [Hook.parse(each) for each in (data if isinstance(data, list) else [data])]:
            self._path(hook.uid)
            if len(self._hooks) >= _MOST_HOOKS:
                raise GrootError(f"there are {_MOST_HOOKS} hooks already")
            self._drop(hook.uid, hook.position)
            self._hooks[hook.uid, hook.position] = self._armed(hook)

    def unlock(self, data: Any) -> None:
        """Let the run go on from a breakpoint, with an answer in the node's place if one is wanted."""
        if not isinstance(data, dict):
            raise GrootError("a JSON object was expected")
        uid, position = number(data, "uid"), Position(number(data, "position", most=1))
        answer = ANSWERS.get(str(data.get("desired_status", "SKIPPED")).upper(), "")
        held = self._at(uid, position)
        is_here = self._stands_at(self._session.state(), uid, position)
        if is_here and answer and position is Position.POST:
            raise GrootError("a node that was ticked has answered itself; break before it")
        if is_here and answer:
            self._do(Force(self._path(uid), answer, once=True, robot=self._robot))
        if data.get("remove_when_done") is True or held.hook.once:
            self._forget(uid, position)
        if is_here:
            self._do(Resume())

    def remove(self, data: Any) -> None:
        """Take a hook away; a run that stands at it goes on."""
        if not isinstance(data, dict):
            raise GrootError("a JSON object was expected")
        uid, position = number(data, "uid"), Position(number(data, "position", most=1))
        self._at(uid, position)
        self._forget(uid, position)
        self._let_go([(uid, position)])

    def remove_all(self) -> None:
        """Take all hooks away."""
        keys = list(self._hooks)
        for uid, position in keys:
            self._forget(uid, position)
        self._let_go(keys)

    def enable_all(self, enabled: bool) -> None:
        """Have all hooks work, or none; a run that stands at one goes on."""
        for key, held in list(self._hooks.items()):
            self._drop(*key)
            self._hooks[key] = self._armed(replace(held.hook, enabled=enabled))
        if not enabled:
            self._let_go(list(self._hooks))

    def dump(self) -> list[dict[str, object]]:
        """All hooks."""
        return [held.hook.as_json() for held in self._hooks.values()]

    def reached(self, state: DebugState) -> int | None:
        """The number of the node at whose breakpoint the run has come to stand; None if it has not."""
        uid = self._uids.get(state.path)
        position = _POSITIONS.get(state.moment)
        if uid is None or position is None or not self._stands_at(state, uid, position):
            return None
        return uid if (uid, position) in self._hooks else None

    def _armed(self, hook: Hook) -> _Set:
        """A hook with what it needs in the session."""
        path = self._path(hook.uid)
        if not hook.enabled:
            return _Set(hook, None)
        if hook.mode is Mode.BREAKPOINT:
            stop = Breakpoint(path, _MOMENTS[hook.position], robot=self._robot, once=hook.once)
            return _Set(hook, self._do(AddBreakpoint(stop)))
        if hook.answer:
            self._do(Force(path, hook.answer, once=hook.once, robot=self._robot))
        return _Set(hook, None)

    def _drop(self, uid: int, position: Position) -> None:
        """Take from the session what a hook put there."""
        held = self._hooks.get((uid, position))
        if held is None:
            return
        with contextlib.suppress(GrootError):  # one that was for once may be gone already
            if held.breakpoint is not None:
                self._do(RemoveBreakpoint(held.breakpoint))
            elif held.hook.mode is Mode.REPLACE:
                self._do(Release(self._path(uid), self._robot))

    def _forget(self, uid: int, position: Position) -> None:
        self._drop(uid, position)
        self._hooks.pop((uid, position), None)

    def _let_go(self, keys: list[tuple[int, Position]]) -> None:
        state = self._session.state()
        if any(self._stands_at(state, *key) for key in keys):
            self._do(Resume())

    def _stands_at(self, state: DebugState, uid: int, position: Position) -> bool:
        here = (state.robot, state.path, state.moment)
        return state.paused and here == (self._robot, self._path(uid), str(_MOMENTS[position]))

    def _at(self, uid: int, position: Position) -> _Set:
        held = self._hooks.get((uid, position))
        if held is None:
            raise GrootError("Node ID not found")
        return held

    def _path(self, uid: int) -> str:
        if uid not in self._paths:
            raise GrootError(f"there is no node {uid}")
        return self._paths[uid]

    def _do(self, command: Command[T]) -> T:
        try:
            return self._session.submit(command).result(_PATIENCE_S)
        except DebugError as refusal:
            raise GrootError(str(refusal)) from None
        except NotYet:
            raise GrootError("the run is busy; ask again") from None

"""What a page may have the debugger do: commands read from JSON, answers written as JSON."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, fields
from typing import Any

from pydantic import TypeAdapter, ValidationError

from explore_bt.debug import (
    AddBreakpoint,
    Command,
    DebugSession,
    EnableBreakpoint,
    Evaluate,
    Force,
    Look,
    Pause,
    Quit,
    Release,
    RemoveBreakpoint,
    Resume,
    SetParam,
    Step,
)
from explore_bt.errors import DebugError
from explore_bt.recording import LoggedMessage, NodeNow, RobotState, stamp_ns, to_json

__all__ = ["Controls"]

PATIENCE_S = 30.0
_KINDS: tuple[type[Command[Any]], ...] = (
    *(Pause, Resume, Step, Quit, AddBreakpoint, RemoveBreakpoint, EnableBreakpoint),
    *(Force, Release, SetParam, Evaluate),
)
_COMMANDS: Mapping[str, TypeAdapter[Any]] = {kind.__name__: TypeAdapter(kind) for kind in _KINDS}
_MEMBERS = {kind.__name__: {each.name for each in fields(kind)} for kind in _KINDS}  # type: ignore[arg-type]  # all are dataclasses


class Controls:
    """A debugger's session, for a page."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session

    def state(self) -> str:
        """The debugger's state as JSON."""
        return json.dumps(asdict(self._session.state()), ensure_ascii=False)

    async def do(self, told: Mapping[str, Any]) -> object:
        """Have a command done; its answer.

        Raises:
            DebugError: it cannot be read, cannot be done, or nobody answers.
        """
        return await self._answer(read_command(told))

    async def look(self, robot: str) -> Callable[[], Iterator[LoggedMessage]]:
        """A robot's tree and blackboard as they are now; what is returned makes messages of them.

        Raises:
            DebugError: no such robot, or nobody answers.
        """
        view = await self._answer(Look(robot))
        state = self._session.state()

        def messages() -> Iterator[LoggedMessage]:
            nodes = {index: NodeNow(node.status, node.message) for index, node in enumerate(view.nodes)}
            board = {name: to_json(value) for name, value in view.blackboard.items()}
            return RobotState(state.tick, nodes, board).messages(view.robot, stamp_ns(state.stamp_s))

        return messages

    async def _answer(self, command: Command[Any]) -> Any:
        try:
            async with asyncio.timeout(PATIENCE_S):
                return await asyncio.wrap_future(self._session.submit(command))
        except TimeoutError:
            raise DebugError(f"no answer in {PATIENCE_S:.0f} s: the run is busy") from None


def read_command(told: Mapping[str, Any]) -> Command[Any]:
    """A command from ``{"do": "Step", "kind": "tick"}``.

    Raises:
        DebugError: it is none.
    """
    name = told.get("do")
    if not isinstance(name, str) or name not in _COMMANDS:
        raise DebugError(f"there is no such command; commands: {', '.join(_COMMANDS)}")
    members = {key: value for key, value in told.items() if key != "do"}
    if unknown := members.keys() - _MEMBERS[name]:
        raise DebugError(f"{name} takes no {', '.join(sorted(unknown))}")
    try:
        return _COMMANDS[name].validate_python(members)
    except ValidationError as fault:
        first = fault.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise DebugError(f"{name}: {where}: {first['msg']}") from None

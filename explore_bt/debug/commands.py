"""What a debugger can be told; every command is answered in the tick thread."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from explore_bt.debug.breakpoint import Breakpoint
from explore_bt.interfaces import NodeState

__all__ = [
    "AddBreakpoint",
    "Command",
    "EnableBreakpoint",
    "Evaluate",
    "Force",
    "Look",
    "Pause",
    "Quit",
    "Release",
    "RemoveBreakpoint",
    "Resume",
    "SetParam",
    "Step",
    "StepKind",
    "View",
]

T = TypeVar("T")


class Command(Generic[T]):
    """Base of the commands; ``T`` is what the future of its answer holds."""

    __slots__ = ()


class StepKind(enum.StrEnum):
    """How far a step goes."""

    TICK = "tick"
    NODE = "node"
    CHANGE = "change"


@dataclass(frozen=True, slots=True)
class Pause(Command[None]):
    """Stand still before the next tick; robots in real time are held.

    Attributes:
        robot: only this one stands, and the others go on; empty for all.
    """

    robot: str = ""


@dataclass(frozen=True, slots=True)
class Resume(Command[None]):
    """Go on to the next breakpoint, or to the end.

    Attributes:
        robot: the one that was paused alone; empty for the run, in which who was paused alone stays so.
    """

    robot: str = ""


@dataclass(frozen=True, slots=True)
class Step(Command[None]):
    """Go on a little and pause again; answered at once, ``DebugState.paused`` tells when it is done.

    Attributes:
        kind: to before the next tick; to after the tick of the next node; or to after the tick of the next
            node whose status differs from the one it had last.
        count: so many times.
        robot: whose nodes count, or who goes on for a tick while the others stand; ``*`` for all robots. One
            that was paused alone makes its ticks while the others go on.
    """

    kind: StepKind = StepKind.TICK
    count: int = 1
    robot: str = "*"


@dataclass(frozen=True, slots=True)
class AddBreakpoint(Command[int]):
    """Watch for a place to stop at; answered with the breakpoint's number."""

    breakpoint: Breakpoint


@dataclass(frozen=True, slots=True)
class RemoveBreakpoint(Command[None]):
    """Forget a breakpoint; number 0 forgets all."""

    number: int


@dataclass(frozen=True, slots=True)
class EnableBreakpoint(Command[None]):
    """Let a breakpoint stop the run or not."""

    number: int
    enabled: bool


@dataclass(frozen=True, slots=True)
class Force(Command[int]):
    """Answer in the place of nodes, which are not ticked; answered with how many nodes are meant.

    Attributes:
        path: as in ``Breakpoint``.
        status: ``success`` or ``failure``.
        once: only the next tick of the first of them that comes; else until released.
        robot: as in ``Breakpoint``.
    """

    path: str
    status: str
    once: bool = False
    robot: str = "*"


@dataclass(frozen=True, slots=True)
class Release(Command[int]):
    """Let forced nodes be ticked again; answered with how many were forced."""

    path: str = "*"
    robot: str = "*"


@dataclass(frozen=True, slots=True)
class SetParam(Command[str]):
    """Change a parameter of the mission while paused, as ``--set name=text`` would have set it.

    Answered with what has changed, in words.
    """

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Evaluate(Command[object]):
    """The value of an expression now; robot empty for the one paused at, else the first."""

    expression: str
    robot: str = ""


@dataclass(frozen=True, slots=True)
class View:
    """One robot's tree and blackboard as they are now, in the middle of a tick too.

    Attributes:
        nodes: in the order of ``RunInfo.trees[robot]``.
        blackboard: entry -> immutable value.
    """

    robot: str
    nodes: tuple[NodeState, ...]
    blackboard: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Look(Command[View]):
    """What a robot's tree and blackboard hold now; robot as in ``Evaluate``."""

    robot: str = ""


@dataclass(frozen=True, slots=True)
class Quit(Command[None]):
    """Stop the robots safely and end the run; its results are saved."""

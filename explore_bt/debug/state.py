"""What a debugger shows of itself."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt.debug.breakpoint import Breakpoint

__all__ = ["BreakpointState", "DebugState", "Forced", "ParamState"]


@dataclass(frozen=True, slots=True)
class BreakpointState:
    """A breakpoint at work.

    Attributes:
        number: by which it is removed.
        nodes: how many nodes it watches.
        hits: how often it would have stopped the run, those ignored included.
        fault: what was wrong with its condition when it was asked last; such a condition does not hold.
    """

    number: int
    breakpoint: Breakpoint
    nodes: int
    hits: int = 0
    fault: str = ""


@dataclass(frozen=True, slots=True)
class Forced:
    """A node that the debugger answers for; ``answers`` counts how often it has."""

    robot: str
    path: str
    status: str
    once: bool
    answers: int = 0


@dataclass(frozen=True, slots=True)
class ParamState:
    """A parameter of the mission: its value as a mission would write it, in SI or degrees."""

    name: str
    type: str
    value: str
    doc: str = ""


@dataclass(frozen=True, slots=True)
class DebugState:
    """The debugger at one moment.

    Attributes:
        paused: whether the trees stand still.
        over: whether the run has ended.
        held: robots that stand while the others go on.
        why: in words, why it is paused, or what it is doing.
        is_simulated: whether time stands still too; else the robots are held while the trees wait.
        robot, path, moment, status: the node it is paused at; empty between two ticks and while running.
        tick: index of the ``TickSnapshot`` that comes next.
        stamp_s: mission time.
        breakpoints: in the order they were set.
        forced: nodes that are answered for.
        params: the mission's parameters, with their present values.
    """

    paused: bool = False
    over: bool = False
    held: tuple[str, ...] = ()
    why: str = "getting ready"
    is_simulated: bool = True
    robot: str = ""
    path: str = ""
    moment: str = ""
    status: str = ""
    tick: int = 0
    stamp_s: float = 0.0
    breakpoints: tuple[BreakpointState, ...] = ()
    forced: tuple[Forced, ...] = ()
    params: tuple[ParamState, ...] = ()

"""A mission tick by tick: pause, step, breakpoints, forced answers, parameters, time travel."""

from explore_bt.debug.breakpoint import STATUSES, Breakpoint, Moment
from explore_bt.debug.commands import (
    AddBreakpoint,
    Command,
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
    StepKind,
    View,
)
from explore_bt.debug.expression import Expression, ExpressionError
from explore_bt.debug.history import History
from explore_bt.debug.params import Params
from explore_bt.debug.session import DebugSession
from explore_bt.debug.sight import NAMES
from explore_bt.debug.state import BreakpointState, DebugState, Forced, ParamState

__all__ = [
    "NAMES",
    "STATUSES",
    "AddBreakpoint",
    "Breakpoint",
    "BreakpointState",
    "Command",
    "DebugSession",
    "DebugState",
    "EnableBreakpoint",
    "Evaluate",
    "Expression",
    "ExpressionError",
    "Force",
    "Forced",
    "History",
    "Look",
    "Moment",
    "ParamState",
    "Params",
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

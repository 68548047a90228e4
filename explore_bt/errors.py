"""Every error that explore-bt raises on purpose.

::

    ExploreError
    ├── UserError                 the user's input is at fault: exit code 2, no traceback
    │   ├── MissionError          a mission file: carries every fault found in it
    │   ├── WorldError            a world, map or start pose
    │   ├── LogError              a recorded log that cannot be read
    │   │   └── LogCutOff         one that ends in the middle; what came before it was sound
    │   ├── DebugError            a command to the debugger that cannot be done
    │   └── PluginError           a plugin that is unknown, broken, doubled or wrongly configured
    ├── PlanningFailure           a planner's typed "no": a tree can branch on its class
    │   ├── NoPath · StartBlocked · GoalBlocked · GoalUnknown · Cancelled
    └── ComponentFailure          a plugin that raised or went silent while the robot was driving

A message names the place, what was found, what was expected, and what to type next.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

__all__ = [
    "Cancelled",
    "ComponentFailure",
    "DebugError",
    "ExploreError",
    "Fault",
    "GoalBlocked",
    "GoalUnknown",
    "LogCutOff",
    "LogError",
    "MissionError",
    "NoPath",
    "PlanningFailure",
    "PluginError",
    "StartBlocked",
    "UserError",
    "WorldError",
]


class ExploreError(Exception):
    """The root of the tree above."""


class UserError(ExploreError):
    """The input is at fault; the message alone must be enough to mend it."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing wrong in a mission.

    Attributes:
        file: as the user named it; ``--set name=value`` for a fault in an override.
        line, column: from 1; line 0 where the file has none (an override, a file that cannot be read).
        message: what was found, one phrase.
        hint: what to write instead; may be empty.
        excerpt: the source line.
        width: how many characters of it are meant.
    """

    file: str
    line: int
    column: int
    message: str
    hint: str = ""
    excerpt: str = ""
    width: int = 1

    @property
    def place(self) -> str:
        """``file:line:column``, as editors and terminals follow it."""
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


class MissionError(UserError):
    """A mission file with faults; ``str()`` shows all of them, each with its place."""

    def __init__(self, message: str, faults: Sequence[Fault] = ()) -> None:
        super().__init__(message)
        self.faults = tuple(faults)


class WorldError(UserError):
    """A world or map file that cannot be used, or a start pose that lies in a wall."""


class LogError(UserError):
    """A recorded log, or relations to judge it by, that cannot be read; names the line or the byte."""


class LogCutOff(LogError):
    """A log that ends in the middle of a message; all before it has been read and is sound."""


class DebugError(UserError):
    """A command to the debugger that cannot be done; the run goes on as if it had not been given."""


class PluginError(UserError):
    """A plugin that is unknown, broken, registered twice, or given options it does not take."""


class PlanningFailure(ExploreError):
    """A planner found no path; the class says why, ``code`` is its name on the blackboard."""

    code: ClassVar[str] = "planning_failure"


class NoPath(PlanningFailure):
    """Start and goal are both free, but no passage wide enough joins them."""

    code = "no_path"


class StartBlocked(PlanningFailure):
    """The footprint does not fit where the robot stands, nor in a short way around it."""

    code = "start_blocked"


class GoalBlocked(PlanningFailure):
    """The footprint does not fit at the goal."""

    code = "goal_blocked"


class GoalUnknown(PlanningFailure):
    """The goal lies in unknown space or outside the map."""

    code = "goal_unknown"


class Cancelled(PlanningFailure):
    """The caller asked the planner to give up."""

    code = "cancelled"


class ComponentFailure(ExploreError):
    """A plugin raised or went silent at run time; the robot stops and the reason is recorded."""

    def __init__(self, component: str, reason: str) -> None:
        super().__init__(f"{component}: {reason}")
        self.component = component
        self.reason = reason

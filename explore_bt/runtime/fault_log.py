"""Plugins that break down while the robot drives: told every time, traced once."""

from __future__ import annotations

import logging
from collections.abc import Callable

__all__ = ["FaultLog"]

_log = logging.getLogger("explore_bt")


class FaultLog:
    """One robot's.

    Args:
        robot: its name.
        tell: takes level, source and message of an event.
    """

    def __init__(self, robot: str, tell: Callable[[str, str, str], None]) -> None:
        self._robot = robot
        self._tell = tell
        self._logged: set[tuple[str, str]] = set()

    def note(self, component: str, error: Exception) -> None:
        """Tell the observers; the log gets the traceback too, once for every fault."""
        fault = (component, repr(error))
        self._tell("error", *fault)
        if fault not in self._logged:
            self._logged.add(fault)
            _log.error("robot %s: %s failed", self._robot, component, exc_info=error)

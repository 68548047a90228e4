"""What others on ROS 2 may ask of a mission."""

from __future__ import annotations

import enum
import queue
import threading
from functools import partial
from typing import Any

from std_srvs.srv import Trigger

from explore_bt.interfaces import Request
from explore_bt_ros2.link import Link

__all__ = ["MissionState", "Services"]


class MissionState(enum.StrEnum):
    """What whoever calls the services is told of the mission."""

    WAITING = enum.auto()
    """For the first call of ``explore``."""
    EXPLORING = enum.auto()
    PAUSED = enum.auto()
    OVER = enum.auto()


_ANSWERS = {
    "stop": (Request.STOP, "the robot brakes, then the results are saved"),
    "pause": (Request.PAUSE, "the robot brakes and stands until go_on is called"),
    "go_on": (Request.GO_ON, "the mission goes on"),
    "save_map": (Request.SAVE_MAP, "the map as it is now goes to the run's folder"),
    "explore": (
        Request.GO_ON,
        "exploring; ~/feedback tells how it goes, ~/result how it ended, ~/stop ends it",
    ),
}
_NEXT = {"pause": MissionState.PAUSED, "go_on": MissionState.EXPLORING, "explore": MissionState.EXPLORING}


class Services:
    """Triggers below the node's name: stop, pause, go_on, save_map, explore.

    ``explore`` is the goal of an action, ``~/feedback`` and ``~/result`` are its feedback and its result, and
    ``stop`` cancels it: all of them standard messages, so that nobody has to build our interfaces.

    Args:
        link: to the others.
        waits: whether the mission begins only when ``explore`` is called.
    """

    def __init__(self, link: Link, *, waits: bool) -> None:
        self._asked: queue.SimpleQueue[Request] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._state = MissionState.WAITING if waits else MissionState.EXPLORING
        if waits:
            self._asked.put(Request.PAUSE)
        for name in _ANSWERS:
            link.node.create_service(Trigger, f"~/{name}", partial(self._answer, name))

    @property
    def state(self) -> MissionState:
        """Of the mission, as the services have it."""
        return self._state

    def asked(self) -> list[Request]:
        """Since the last call."""
        found = []
        while not self._asked.empty():
            found.append(self._asked.get())
        return found

    def end(self) -> None:
        """The mission is over: nothing can be asked of it any more."""
        with self._lock:
            self._state = MissionState.OVER

    def _answer(self, name: str, _: Any, response: Any) -> Any:
        with self._lock:
            response.message = self._refusal(name)
            response.success = not response.message
            if response.success:
                request, response.message = _ANSWERS[name]
                self._asked.put(request)
                self._state = _NEXT.get(name, self._state)
        return response

    def _refusal(self, name: str) -> str:
        if self._state is MissionState.OVER:
            return "it is over; ~/result tells how it ended"
        if name == "explore" and self._state is MissionState.EXPLORING:
            return "it explores already; ~/feedback tells how it goes"
        return ""

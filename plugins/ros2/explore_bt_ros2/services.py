"""What others on ROS 2 may ask of a mission."""

from __future__ import annotations

import queue
from functools import partial
from typing import Any

from std_srvs.srv import Trigger

from explore_bt.interfaces import Request
from explore_bt_ros2.link import Link

__all__ = ["Services"]

_ANSWERS = {
    "stop": (Request.STOP, "the robot brakes, then the results are saved"),
    "pause": (Request.PAUSE, "the robot brakes and stands until go_on is called"),
    "go_on": (Request.GO_ON, "the mission goes on"),
    "save_map": (Request.SAVE_MAP, "the map as it is now goes to the run's folder"),
    "explore": (Request.GO_ON, "exploring; ~/tree tells how it goes, ~/result how it ended, ~/stop ends it"),
}


class Services:
    """Triggers below the node's name: stop, pause, go_on, save_map, explore.

    Args:
        link: to the others.
        waits: whether the mission begins only when ``explore`` is called.
    """

    def __init__(self, link: Link, *, waits: bool) -> None:
        self._asked: queue.SimpleQueue[Request] = queue.SimpleQueue()
        if waits:
            self._asked.put(Request.PAUSE)
        for name in _ANSWERS:
            link.node.create_service(Trigger, f"~/{name}", partial(self._answer, name))

    def asked(self) -> list[Request]:
        """Since the last call."""
        found = []
        while not self._asked.empty():
            found.append(self._asked.get())
        return found

    def _answer(self, name: str, _: Any, response: Any) -> Any:
        request, words = _ANSWERS[name]
        self._asked.put(request)
        response.success, response.message = True, words
        return response

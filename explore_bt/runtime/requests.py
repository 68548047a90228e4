"""What people ask of a mission through its robots: stop, pause, go on, save the map."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from explore_bt.interfaces import Request
from explore_bt.maps import write_map
from explore_bt.runtime.robot import Robot
from explore_bt.runtime.stop_flag import StopFlag

__all__ = ["Requests"]


class Requests:
    """Asks the drivers, and does what can be done at once.

    Args:
        robots: whose buttons and services are listened to.
        stop: raised by whoever asks for it.
        folder: takes the maps that are saved.
    """

    def __init__(self, robots: Sequence[Robot], stop: StopFlag, folder: Path) -> None:
        self._robots = robots
        self._stop = stop
        self._folder = folder
        self._paused_by = ""

    def heed(self, hold: Callable[[str], None], paused: dict[str, str]) -> None:
        """Called before a tick: takes what was asked, and stands while paused; of several that robot does.

        Args:
            hold: one control period of all at rest, for a reason.
            paused: robot -> why it stands while the others go on.
        """
        self._take(paused)
        while self._paused_by and not self._stop.is_raised:
            hold(f"paused by a request to robot {self._paused_by}")
            self._take(paused)

    def _take(self, paused: dict[str, str]) -> None:
        for robot, request in self._asked():
            robot.tell("info", "request", str(request))
            if request is Request.STOP:
                self._stop.raise_flag(f"stopped by a request to robot {robot.name}")
            elif request is Request.SAVE_MAP:
                self._save(robot)
            elif len(self._robots) == 1:
                self._paused_by = robot.name if request is Request.PAUSE else ""
            elif request is Request.PAUSE:
                paused[robot.name] = f"paused by a request to robot {robot.name}"
            else:
                paused.pop(robot.name, None)

    def _asked(self) -> Iterator[tuple[Robot, Request]]:
        for robot in self._robots:
            for request in robot.driver.asked():
                yield robot, request

    def _save(self, robot: Robot) -> None:
        folder = self._folder if len(self._robots) == 1 else self._folder / robot.name
        try:
            folder.mkdir(exist_ok=True)
            write_map(robot.slam.grid(), folder)
        except OSError as error:
            robot.tell("error", "request", f"the map cannot be saved: {error}")

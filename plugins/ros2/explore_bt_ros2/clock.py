"""Mission time on ROS 2: the system's clock, or what ``/clock`` says."""

from __future__ import annotations

import threading
import time
from abc import abstractmethod

from explore_bt.clock import Clock

__all__ = ["RosClock", "SimTimeClock", "SystemTimeClock"]

_SILENT_S = 0.2
_POLL_S = 0.02


class RosClock(Clock):
    """A clock that knows both times: mission time from 0, and the ROS time of stamps."""

    @property
    def is_simulated(self) -> bool:
        """Never: a simulator behind topics cannot be held from here."""
        return False

    @abstractmethod
    def mission_s(self, ros_s: float) -> float:
        """Mission time of a stamp."""

    @abstractmethod
    def stamp_s(self, mission_s: float) -> float:
        """The ROS time of a moment of the mission."""

    @abstractmethod
    def ros_s(self) -> float:
        """The ROS time now, seconds."""

    @abstractmethod
    def since_s(self, mission_s: float, monotonic_s: float) -> float:
        """How long ago a moment is, told by both clocks, for who must not wait for ever where one stands."""

    def fault(self) -> str:
        """Why time cannot be told, in words."""
        return ""


class SystemTimeClock(RosClock):
    """The computer's own clock; mission time does not go back when that is set back.

    Args:
        begin_s: mission time now; above 0 where a run is resumed.
    """

    def __init__(self, begin_s: float = 0.0) -> None:
        self._origin_s = time.time() - begin_s
        self._newest_s = begin_s

    def now_s(self) -> float:
        """Seconds since construction, and ``begin_s``."""
        self._newest_s = max(self._newest_s, time.time() - self._origin_s)
        return self._newest_s

    def wait_until(self, time_s: float) -> None:
        """Sleep until then."""
        while (remaining_s := time_s - self.now_s()) > 0.0:
            time.sleep(remaining_s)

    def mission_s(self, ros_s: float) -> float:
        """Mission time of a stamp."""
        return ros_s - self._origin_s

    def stamp_s(self, mission_s: float) -> float:
        """The ROS time of a moment of the mission."""
        return mission_s + self._origin_s

    def ros_s(self) -> float:
        """The system's time."""
        return time.time()

    def since_s(self, mission_s: float, monotonic_s: float) -> float:
        """The longer of both: the system's clock may be set back."""
        return max(self.now_s() - mission_s, time.monotonic() - monotonic_s)


class SimTimeClock(RosClock):
    """Time as ``/clock`` tells it, kept monotonic.

    While ``/clock`` is silent mission time goes on at the pace of the wall clock: the robot has to brake, and
    Ctrl-C has to be heard. When it speaks again, however far on or back, mission time goes on from where it
    is. ``tell`` is called by the ROS thread.

    Args:
        begin_s: mission time at the first tick; above 0 where a run is resumed.
    """

    def __init__(self, begin_s: float = 0.0) -> None:
        self._ticked = threading.Condition()
        self._begin_s = begin_s
        self._origin_s = 0.0
        self._newest_s = 0.0
        self._heard_s: float | None = None

    def tell(self, ros_s: float) -> None:
        """A tick of ``/clock``."""
        with self._ticked:
            if self._heard_s is None:
                self._origin_s = ros_s - self._begin_s
            elif ros_s < self._newest_s:
                self._origin_s = ros_s - self._now_s()
            elif self._silent_s() > _SILENT_S:
                self._origin_s = min(self._origin_s, ros_s - self._now_s())
            self._newest_s, self._heard_s = ros_s, time.monotonic()
            self._ticked.notify_all()

    def wait_for_first(self, timeout_s: float) -> bool:
        """Whether ``/clock`` has spoken; waits for it."""
        with self._ticked:
            return self._ticked.wait_for(lambda: self._heard_s is not None, timeout_s)

    def now_s(self) -> float:
        """Mission time."""
        with self._ticked:
            return self._now_s()

    def wait_until(self, time_s: float) -> None:
        """Return at the first tick at or after then."""
        with self._ticked:
            while self._now_s() < time_s:
                self._ticked.wait(_POLL_S)

    def mission_s(self, ros_s: float) -> float:
        """Mission time of a stamp."""
        return ros_s - self._origin_s

    def stamp_s(self, mission_s: float) -> float:
        """The ROS time of a moment of the mission."""
        return mission_s + self._origin_s

    def ros_s(self) -> float:
        """What ``/clock`` said last."""
        return self._newest_s

    def since_s(self, mission_s: float, monotonic_s: float) -> float:
        """Mission time, at whatever pace it goes; the time of the wall while ``/clock`` is silent."""
        stands_s = min(self._silent_s(), time.monotonic() - monotonic_s)
        return max(self.now_s() - mission_s, stands_s)

    def fault(self) -> str:
        """That ``/clock`` is silent, and for how long."""
        silent_s = self._silent_s()
        return f"/clock is silent for {silent_s:.1f} s" if silent_s > _SILENT_S else ""

    def _now_s(self) -> float:
        if self._heard_s is None:
            return self._begin_s
        return self._newest_s - self._origin_s + max(self._silent_s() - _SILENT_S, 0.0)

    def _silent_s(self) -> float:
        return 0.0 if self._heard_s is None else time.monotonic() - self._heard_s

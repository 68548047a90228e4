"""The robots of one mission that speak ROS 2."""

from __future__ import annotations

from explore_bt.errors import PluginError
from explore_bt.interfaces import Commons
from explore_bt_ros2.clock import RosClock, SimTimeClock, SystemTimeClock

__all__ = ["Crew"]


class Crew:
    """One clock for all, so that what they tell one another is of the same time; a place of its own for each.

    Args:
        clock: of every robot.
    """

    def __init__(self, clock: RosClock) -> None:
        self.clock = clock
        self._placed: dict[str, bool] = {}
        self._commanded: dict[str, str] = {}

    @classmethod
    def of(cls, commons: Commons, *, use_sim_time: bool, begin_s: float) -> Crew:
        """That of a mission; whoever asks first makes it.

        Args:
            commons: of the mission.
            use_sim_time: time is what ``/clock`` says.
            begin_s: mission time now, where the run is resumed.
        """
        clock = SimTimeClock if use_sim_time else SystemTimeClock
        return commons.get(("ros2", use_sim_time), lambda: cls(clock(begin_s)))

    def join(self, robot: str, command_topic: str, *, has_start: bool) -> bool:
        """One more robot; whether it is the first.

        Args:
            robot: its name.
            command_topic: with its namespace.
            has_start: whether the mission says where it begins.

        Raises:
            PluginError: two robots hear the same commands, or nobody knows where they stand to one another.
        """
        other = self._commanded.setdefault(command_topic, robot)
        if other != robot:
            raise PluginError(
                f"driver ros2: robots {other} and {robot} both hear {command_topic}; give each a namespace: "
                f"driver: {{use: ros2, namespace: {robot}, tf_topic: tf}}"
            )
        self._placed[robot] = has_start
        lost = [name for name, placed in self._placed.items() if not placed]
        if lost and len(self._placed) > 1:
            raise PluginError(
                f"driver ros2: nobody said where {' and '.join(lost)} begin{'s' * (len(lost) == 1)}; "
                "of several robots each needs its pose in their common map: start: [1 m, 2 m, 90 deg]"
            )
        return len(self._placed) == 1

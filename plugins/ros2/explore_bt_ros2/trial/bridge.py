"""Bridge ``ros2``: lets a simulator pass for robots on ROS 2."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from typing import ClassVar

from pydantic import Field

from explore_bt.interfaces import API_VERSION, Bridge, Driver, PluginOptions
from explore_bt_ros2.link import Discovery, Link
from explore_bt_ros2.trial.robot import TrialRobot

__all__ = ["Ros2Bridge", "Ros2BridgeOptions"]

_STEP_S = 0.01
_BEHIND_S = 0.1


class Ros2BridgeOptions(PluginOptions):
    """How a robot appears; of several each has its name as the innermost namespace."""

    namespace: str = Field("", description="before every relative topic name")
    tf_topic: str = Field(
        "", description="empty: /tf of a single robot, tf in the namespace of each of several"
    )
    domain: int | None = Field(None, ge=0, le=232, description="ROS domain; none: ROS_DOMAIN_ID, else 0")
    discovery: Discovery = Field("localhost", description="how far nodes are looked for")
    wall_time: bool = Field(False, description="stamps are the system's time, and there is no /clock")
    stamped: bool = Field(False, description="commands are TwistStamped")


class Ros2Bridge(Bridge):
    """Scan, cloud, IMU, odometry, images, battery, tf and /clock out; cmd_vel in."""

    name = "ros2"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = Ros2BridgeOptions

    def serve(self, robots: Mapping[str, Driver], speed: float, is_over: Callable[[], bool]) -> None:
        """Until it is over; where the machine is too slow for the speed the simulator becomes slower."""
        options = Ros2BridgeOptions.model_validate(self.options.model_dump())
        now_s = max(driver.clock.now_s() for driver in robots.values())
        pace = _Pace(now_s, 1.0 if options.wall_time else speed, options.wall_time)
        with ExitStack() as opened:
            shown = [
                (driver, self._shown(opened, name if len(robots) > 1 else "", options, pace))
                for name, driver in robots.items()
            ]
            for driver in robots.values():
                opened.callback(driver.stop)
            self._run(shown, pace, now_s, is_over)

    def _shown(self, opened: ExitStack, name: str, options: Ros2BridgeOptions, pace: _Pace) -> TrialRobot:
        """One robot on ROS 2; ``name`` is empty for a single one."""
        namespace = "/".join(each for each in (options.namespace, name) if each)
        link = Link("trial_robot", namespace, options.domain, options.discovery)
        opened.callback(link.close)
        tf_topic = options.tf_topic or ("tf" if name else "/tf")
        robot = TrialRobot(link, pace.ros_s, tf_topic, stamped=options.stamped)
        link.start()
        return robot

    def _run(
        self,
        shown: Sequence[tuple[Driver, TrialRobot]],
        pace: _Pace,
        now_s: float,
        is_over: Callable[[], bool],
    ) -> None:
        pace.begin(now_s)
        while not is_over():
            now_s += _STEP_S
            pace.wait_until(now_s)
            for driver, robot in shown:
                command = robot.command()
                if command is not None:
                    driver.command(command)
            for driver, _ in shown:
                driver.clock.wait_until(now_s)
            if not pace.is_wall_time:
                shown[0][1].tick(now_s)
            for driver, robot in shown:
                for measured in driver.read():
                    robot.publish(measured)


class _Pace:
    """How simulated time goes with real time."""

    def __init__(self, now_s: float, speed: float, is_wall_time: bool) -> None:
        self._speed = speed
        self.is_wall_time = is_wall_time
        self.begin(now_s)

    def begin(self, now_s: float) -> None:
        """From here on."""
        self._begin_s, self._wall_s = now_s, time.monotonic()
        self._zero_s = time.time() - now_s if self.is_wall_time else 0.0

    def wait_until(self, now_s: float) -> None:
        """Sleep until a simulated moment; a machine that is far behind lets it be later."""
        ahead_s = (now_s - self._begin_s) / self._speed - (time.monotonic() - self._wall_s)
        if ahead_s > 0.0:
            time.sleep(ahead_s)
        elif ahead_s < -_BEHIND_S:
            self.begin(now_s)

    def ros_s(self, stamp_s: float) -> float:
        """Stamp of a simulated moment."""
        return self._zero_s + stamp_s

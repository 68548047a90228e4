"""Driver ``ros2``: a robot that speaks ROS 2."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock as ClockMessage

from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Driver, Finding, PluginOptions, Request, RobotContext, Sink
from explore_bt.types import BodyShape, Measurement, MotionLimits, Pose2, Twist2
from explore_bt_ros2.clock import RosClock, SimTimeClock
from explore_bt_ros2.commander import COMMAND_LIFE_S, Commander
from explore_bt_ros2.connection import Connection
from explore_bt_ros2.crew import Crew
from explore_bt_ros2.link import Link
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.outputs import Ros2Outputs
from explore_bt_ros2.parameters import with_parameters
from explore_bt_ros2.senses import Senses
from explore_bt_ros2.services import Services
from explore_bt_ros2.stamps import seconds_of
from explore_bt_ros2.survey import survey
from explore_bt_ros2.transforms import TransformBuffer

__all__ = ["Ros2"]

_CLOCK_TIMEOUT_S = 10.0
_DISCOVERY_S = 5.0
"""So long the first scan is waited for: nodes announce themselves every three seconds."""


class Ros2(Driver):
    """Sensors from topics, commands to ``/cmd_vel``; brakes, and says why, when a topic goes wrong.

    Callbacks run in one thread and leave messages for ``read`` to fetch. The ``map`` frame begins where the
    robot stands, unless the mission says otherwise.
    """

    name = "ros2"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = Ros2Options

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        assert isinstance(options, Ros2Options)
        self._options = options
        self._connection: Connection | None = None
        self._senses: Senses | None = None
        self._commander: Commander | None = None
        self._services: Services | None = None
        self._outputs: tuple[Ros2Outputs, ...] = ()
        self._start = Pose2.identity()

    def setup(self, context: RobotContext) -> None:
        """Join the network and subscribe; with ``use_sim_time``, wait for ``/clock``.

        Raises:
            PluginError: ROS 2 cannot be started, no lidar is named, nobody tells the time,
                the file of parameters is at fault, or two robots are taken for one.
        """
        options = self._options = with_parameters(self._options)
        if not (options.scan_topic or options.cloud_topic):
            raise PluginError(
                "driver ros2: scan_topic and cloud_topic are both empty; name the lidar's topic"
            )
        begin_s = context.resumed.stamp_s if context.resumed else 0.0
        crew = Crew.of(context.commons, use_sim_time=options.use_sim_time, begin_s=begin_s)
        clock = crew.clock
        link = Link("explore_bt", options.namespace, options.domain, options.discovery)
        self._connection = Connection(link, clock, TransformBuffer(), options)
        command_topic = link.full_name(options.command_topic)
        is_first = crew.join(context.robot, command_topic, has_start=context.start is not None)
        if isinstance(clock, SimTimeClock) and is_first:
            _follow(clock, link)
        self._senses = Senses(link, options, clock, self._connection.buffer)
        self._commander = Commander(link, options, clock)
        self._start = context.start or Pose2.identity()
        if options.outputs:
            self._services = Services(link, waits=options.start_when_asked)
            self._outputs = (Ros2Outputs(self._connection, self._services, context.robot),)
        link.start()
        if isinstance(clock, SimTimeClock) and not clock.wait_for_first(_CLOCK_TIMEOUT_S):
            self.close()
            raise PluginError(
                f"driver ros2: use_sim_time is set and /clock was silent for {_CLOCK_TIMEOUT_S:.0f} s; "
                "start the simulator (explore-bt ros2-sim), or set use_sim_time: false"
            )
        self._senses.wait_for_lidar(_DISCOVERY_S)

    @property
    def clock(self) -> RosClock:
        """The system's time, or ``/clock``; runs by itself."""
        return self.connection.clock

    @property
    def connection(self) -> Connection:
        """Node, clock and tf buffer."""
        if self._connection is None:
            raise RuntimeError("ros2 is used before setup()")
        return self._connection

    @property
    def command_delay_s(self) -> float:
        """As the options say."""
        return self._options.command_delay

    @property
    def command_life_s(self) -> float:
        """Until the zero that is sent where no other command comes."""
        return COMMAND_LIFE_S

    @property
    def footprint_radius_m(self) -> float:
        """As the options say."""
        return self._options.radius

    @property
    def shape(self) -> BodyShape:
        """As the options say."""
        return self._options.shape

    @property
    def limits(self) -> MotionLimits:
        """As the options say."""
        return self._options.limits

    @property
    def start(self) -> Pose2:
        """As given, or the origin."""
        return self._start

    def read(self) -> Sequence[Measurement]:
        """Every good message since the last call, as a measurement."""
        return self._senses.read() if self._senses else ()

    def hindrance(self) -> str:
        """A pressed emergency stop, a silent topic, a clock that stands, in words."""
        return self._senses.fault() if self._senses else ""

    def command(self, twist: Twist2) -> None:
        """Publish it; a zero follows by itself if no other comes within 0.2 s."""
        if self._commander:
            self._commander.send(twist)

    def stop(self) -> None:
        """Publish a zero."""
        if self._commander:
            self._commander.stop()

    def asked(self) -> Sequence[Request]:
        """What was called: stop, pause, go_on, save_map, explore."""
        return self._services.asked() if self._services else ()

    def observers(self) -> Sequence[Sink]:
        """Map, path, marks, diagnostics, tree, as topics."""
        return self._outputs

    def survey(self, listen_s: float) -> Sequence[Finding]:
        """Topics, types, rates, frames, delays, QoS, tf, and who listens to the commands."""
        assert self._senses is not None
        return survey(self.connection, self._senses, listen_s)

    def close(self) -> None:
        """Publish a zero and leave the network."""
        if self._commander:
            self._commander.close()
        if self._connection:
            self._connection.link.close()


def _follow(clock: SimTimeClock, link: Link) -> None:
    """Have the clock told what ``/clock`` says."""
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    link.subscribe(ClockMessage, "/clock", lambda tick: clock.tell(seconds_of(tick.clock)), qos)

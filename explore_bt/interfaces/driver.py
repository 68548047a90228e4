"""Contract of drivers: the robot's body, simulated or real."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from explore_bt.clock import Clock
from explore_bt.interfaces.filming import Filming
from explore_bt.interfaces.finding import Finding
from explore_bt.interfaces.plugin import Plugin, RobotContext
from explore_bt.interfaces.request import Request
from explore_bt.interfaces.sink import Sink
from explore_bt.interfaces.truth import GroundTruth
from explore_bt.types import BodyFault, BodyShape, Measurement, MotionLimits, Pose2, Twist2

__all__ = ["Driver"]


class Driver(Plugin):
    """Sensors in, twists out.

    Life: ``setup`` once, then ``read`` and ``command`` from the control thread, ``stop`` from any thread
    at any time, ``close`` once. Properties are valid after ``setup``.
    """

    kind = "driver"
    films: ClassVar[bool] = False
    """Whether ``filming`` gives pictures: asked before anything is set up."""
    is_simulated: ClassVar[bool] = False
    """Whether there is no robot but in this process."""
    shows_mates: ClassVar[bool] = True
    """Whether scans show the bodies of team mates that are near."""

    @abstractmethod
    def setup(self, context: RobotContext) -> None:
        """Open hardware or load the world; may take seconds.

        Where ``context.resumed`` says so, the clock begins at that mission time (``WallClock(begin_s)``),
        and a simulator has the body stand where it says; a driver that cannot do that is not resumed.

        Raises:
            WorldError: a world that cannot be used, or a start inside an obstacle.
            PluginError: options that do not fit this machine.
        """

    @property
    @abstractmethod
    def clock(self) -> Clock:
        """The mission's time. A simulator's clock advances its world when someone waits on it."""

    @property
    @abstractmethod
    def footprint_radius_m(self) -> float:
        """Radius of the circular footprint about ``base_link``."""

    @property
    def shape(self) -> BodyShape:
        """What else is to be known of the body, where the lidar is a 3D one."""
        return BodyShape()

    @property
    @abstractmethod
    def limits(self) -> MotionLimits:
        """What the body can do; the mission may ask for less."""

    @property
    def command_delay_s(self) -> float:
        """How long the body lags behind its commands; what it still has to drive counts as driven."""
        return 0.0

    @property
    def command_life_s(self) -> float:
        """How long a command may drive on before the driver halts the body because no other has come.

        The safety gate has every command end in a stop from there. 0 where the next one always comes in time.
        """
        return 0.0

    @property
    @abstractmethod
    def start(self) -> Pose2:
        """Pose of ``base_link`` in ``map`` at set-up: as given, or as the driver chose."""

    @abstractmethod
    def read(self) -> Sequence[Measurement]:
        """All measurements since the last call, in time order. Never blocks; empty is fine."""

    @abstractmethod
    def command(self, twist: Twist2) -> None:
        """Drive at this twist until the next command. A driver stops by itself if none comes for 0.5 s."""

    @abstractmethod
    def stop(self) -> None:
        """Halt as fast as is safe for the body. Idempotent, from any thread, never raises."""

    @property
    def fault(self) -> BodyFault | None:
        """Why the body cannot drive now: it has fallen, its own emergency stop is pressed. Cheap.

        Commands are not heard meanwhile, the stack above holds still.
        """
        return None

    def recover(self) -> bool:
        """Begin to get out of ``fault``, without waiting for it; False where the body cannot."""
        return False

    @abstractmethod
    def close(self) -> None:
        """Stop and let go of everything. Idempotent."""

    def truth(self) -> GroundTruth | None:
        """The truth, where the driver is a simulator."""
        return None

    def filming(self, size: tuple[int, int]) -> Filming | None:  # noqa: ARG002  # most worlds have no looks
        """Pictures of the simulated world, ``size`` being width and height in pixels; after ``setup``.

        Raises:
            UserError: what draws them is not installed.
        """
        return None

    def hindrance(self) -> str:
        """Why the robot must not drive now, in words: a silent topic, a pressed emergency stop; else empty.

        Asked every control period, so cheap. While there is a reason the robot brakes, and stands.
        """
        return ""

    def asked(self) -> Sequence[Request]:
        """What people asked through the robot's own buttons or services since the last call."""
        return ()

    @property
    def connection(self) -> object:
        """What plugins of the same family share with the driver (``RobotContext.connection``)."""
        return None

    def observers(self) -> Sequence[Sink]:
        """Sinks that this robot wants to look on, made after ``setup``."""
        return ()

    def survey(self, listen_s: float) -> Sequence[Finding]:  # noqa: ARG002  # those that can listen do
        """What can be heard of the robot while it stands; called after ``setup``, may take ``listen_s``."""
        return ()

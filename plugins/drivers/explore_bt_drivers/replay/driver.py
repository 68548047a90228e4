"""Driver ``replay``: a recorded log in place of a robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import ClassVar

from explore_bt.clock import Clock, ManualClock
from explore_bt.interfaces import API_VERSION, Driver, Playback, PluginOptions, Recorded, RobotContext
from explore_bt.types import Measurement, MotionLimits, Pose2, Twist2
from explore_bt_drivers.replay.log import MeasurementLog
from explore_bt_drivers.replay.open_log import open_log
from explore_bt_drivers.replay.options import ReplayOptions
from explore_bt_drivers.replay.stamps import ReplayTime

__all__ = ["Replay"]

_USUAL_RADIUS_M = 0.25


class Replay(Driver, Playback):
    """What a robot once measured, played again in file order; it obeys nobody.

    The clock is simulated and begins with the log's first measurement; see ``ReplayTime`` for stamps that go
    back. Commands and stops are accepted and change nothing: the way has been driven already. After the
    log's end time goes on and nothing more is measured, as with a robot whose sensors have fallen silent.
    """

    name = "replay"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = ReplayOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        assert isinstance(options, ReplayOptions)
        self._options = options
        self._clock: ManualClock | None = None
        self._start = Pose2.identity()
        self._radius_m = _USUAL_RADIUS_M
        self._log: MeasurementLog | None = None
        self._coming: Iterator[Recorded] = iter(())
        self._next: Recorded | None = None

    def setup(self, context: RobotContext) -> None:
        """Open the log and read its first measurement.

        Raises:
            LogError: a log that cannot be read.
        """
        self._clock = ManualClock()
        self._coming = self.recorded()
        self._next = next(self._coming, None)
        assert self._log is not None
        self._start = context.start or self._log.start or Pose2.identity()
        self._radius_m = self._options.radius or self._log.radius_m or _USUAL_RADIUS_M

    @property
    def clock(self) -> Clock:
        """Simulated time since the log's first measurement."""
        if self._clock is None:
            raise RuntimeError("replay is used before setup()")
        return self._clock

    @property
    def footprint_radius_m(self) -> float:
        """Radius of the circular footprint."""
        return self._radius_m

    @property
    def limits(self) -> MotionLimits:
        """What the recorded robot kept to, as far as the options say."""
        return self._options.limits

    @property
    def start(self) -> Pose2:
        """As given or as recorded, or the origin: a log's map begins where its robot stood."""
        return self._start

    def read(self) -> Sequence[Measurement]:
        """What the log holds up to now.

        Raises:
            LogError: the log goes on with something that cannot be understood, or ends in the middle.
        """
        now_s, measured = self.clock.now_s(), []
        while self._next is not None and self._next.measurement.stamp_s <= now_s:
            measured.append(self._next.measurement)
            self._next = next(self._coming, None)
        return measured

    def command(self, twist: Twist2) -> None:
        """Not heard."""

    def stop(self) -> None:
        """Not heard."""

    def close(self) -> None:
        """Play nothing more."""
        self._coming, self._next = iter(()), None

    def recorded(self) -> Iterator[Recorded]:
        """Everything from the log's begin."""
        log = self._log = open_log(self._options)
        time = ReplayTime()
        for measurement in log:
            stamp_s = time.of(measurement.stamp_s, type(measurement))
            yield Recorded(replace(measurement, stamp_s=stamp_s), measurement.stamp_s)

    @property
    def progress(self) -> float:
        """Share of the log last opened."""
        return self._log.progress if self._log is not None else 0.0

    @property
    def notes(self) -> Sequence[str]:
        """What had to be assumed about the log last opened."""
        return tuple(self._log.notes) if self._log is not None else ()

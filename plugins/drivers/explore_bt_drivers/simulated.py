"""What the drivers of simulated robots have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Generic, Protocol, TypeVar

from explore_bt.interfaces import Driver, GroundTruth
from explore_bt.types import Measurement, Pose2, Twist2

__all__ = ["Sensor", "SensorDeck", "Simulated", "SimulatedDriver"]

TrackT = TypeVar("TrackT", contravariant=True)


class Sensor(Protocol[TrackT]):
    """Measures along the track of a body."""

    def begin(self, track: TrackT) -> None:
        """Measure from here on."""

    def measure(self, track: TrackT) -> Sequence[Measurement]:
        """What was measured since the last call."""


class SensorDeck(Generic[TrackT]):
    """The sensors of one robot; what they measure queues up until it is drained."""

    def __init__(self, sensors: Sequence[Sensor[TrackT]], track: TrackT) -> None:
        self._sensors = sensors
        self._queue: list[Measurement] = []
        for sensor in sensors:
            sensor.begin(track)

    def measure(self, track: TrackT) -> None:
        """Take what the sensors have to tell by now."""
        fresh = [found for sensor in self._sensors for found in sensor.measure(track)]
        fresh.sort(key=lambda measurement: measurement.stamp_s)
        self._queue += fresh

    def drain(self) -> list[Measurement]:
        """Everything measured since the last call, in time order."""
        measured, self._queue = self._queue, []
        return measured


class _Body(Protocol):
    def command(self, twist: Twist2) -> None:
        """Drive at this twist."""

    def halt(self) -> None:
        """Come to rest."""


class Simulated(Protocol):
    """One robot in its world."""

    @property
    def body(self) -> _Body:
        """What takes commands."""

    @property
    def sensors(self) -> SensorDeck[Any]:
        """What measures."""


SimulationT = TypeVar("SimulationT", bound=Simulated)


class SimulatedDriver(Driver, Generic[SimulationT]):
    """The way of commands and measurements; ``setup`` has to give it its simulation."""

    is_simulated = True
    _simulation: SimulationT | None = None
    _truth: GroundTruth | None = None
    _start: Pose2 | None = None
    _closed = False

    @property
    def start(self) -> Pose2:
        """As given, or as the world's file says, or the widest free spot."""
        self._running()
        assert self._start is not None
        return self._start

    def read(self) -> Sequence[Measurement]:
        """Everything measured while the clock was waited on since the last call."""
        return self._running().sensors.drain()

    def command(self, twist: Twist2) -> None:
        """Drive at this twist, as far as the limits allow, for at most 0.5 s."""
        if not self._closed:
            self._running().body.command(twist)

    def stop(self) -> None:
        """Brake at the limits and stand until the next command; from any thread."""
        if self._simulation is not None:
            self._simulation.body.halt()

    def close(self) -> None:
        """Stop; later commands are not heard."""
        self.stop()
        self._closed = True

    def truth(self) -> GroundTruth | None:
        """Pose, contacts, clearance, people, and the floor that can be explored."""
        return self._truth

    def _running(self) -> SimulationT:
        if self._simulation is None:
            raise RuntimeError(f"{self.name} is used before setup()")
        return self._simulation

"""What every reader of recorded logs is."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from explore_bt.types import Measurement, Pose2

__all__ = ["MeasurementLog"]


class MeasurementLog(ABC):
    """A file of measurements, read lazily and in file order; iterate over it once.

    Measurements carry the log's own stamps, whatever clock they are of, and also where they go back.

    Attributes:
        path: the file.
        held: what has come so far, by kind and frame: ``{"Scan2D laser": 120}``.
        passed_over: messages so far that no measurement type exists for, by their name.
        notes: what had to be assumed, one sentence each.
        start: where in ``map`` the robot stood at the first measurement, if the log says so.
        radius_m: radius of its footprint, if the log says so. Both are known with the first measurement.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.held: Counter[str] = Counter()
        self.passed_over: Counter[str] = Counter()
        self.notes: list[str] = []
        self.start: Pose2 | None = None
        self.radius_m: float | None = None

    def __iter__(self) -> Iterator[Measurement]:
        """All measurements.

        Raises:
            LogError: a message that cannot be understood; names its line, byte or index.
            LogCutOff: the log ends in the middle of a message.
        """
        for measurement in self._read():
            self.held[f"{type(measurement).__name__} {measurement.frame}"] += 1
            yield measurement

    @property
    @abstractmethod
    def progress(self) -> float:
        """Share [0, 1] of the file that has been read, by bytes or messages."""

    @abstractmethod
    def _read(self) -> Iterator[Measurement]:
        """The measurements; closes the file when it is exhausted or given up."""

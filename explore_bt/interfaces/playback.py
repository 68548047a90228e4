"""What a driver offers besides, if its measurements were recorded: all of them, one after the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from explore_bt.types import Measurement

__all__ = ["Playback", "Recorded"]


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """A measurement in mission time, and the stamp that the log gave it (seconds of whatever clock)."""

    measurement: Measurement
    log_stamp_s: float


class Playback(ABC):
    """A recorded log without the waiting: for building a map as fast as it can be computed."""

    @abstractmethod
    def recorded(self) -> Iterator[Recorded]:
        """Everything from the log's begin, lazily, in file order; mission time never goes back.

        Raises:
            LogError: a message that cannot be understood; names its line, byte or index.
            LogCutOff: the log ends in the middle of a message.
        """

    @property
    @abstractmethod
    def progress(self) -> float:
        """Share [0, 1] of the log that ``recorded`` has read."""

    @property
    @abstractmethod
    def notes(self) -> Sequence[str]:
        """What had to be assumed about the log so far, one sentence each."""

"""Where a run broke off, for the robot that is to go on from there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from explore_bt.checkpoint import RobotMemory, RunMemory
from explore_bt.errors import UserError
from explore_bt.interfaces import Driver, Event, Resumption, RunInfo, TickSnapshot
from explore_bt.types import Measurement, Score, Trajectory

__all__ = ["Cut", "CutRun", "check_clock"]

_LATE_S = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """One robot when its run broke off.

    Attributes:
        memory: of the checkpoint; ``slam_folder`` is what SLAM saved with it.
        measured: what SLAM was given after the checkpoint, as far as it is known, in this order.
        score: the last one recorded after the checkpoint; None: the checkpoint's own.
        true_way: the true poses recorded after the checkpoint; None without a simulator.
    """

    resumption: Resumption
    memory: RobotMemory
    slam_folder: Path
    measured: Sequence[Measurement] = ()
    score: Score | None = None
    true_way: Trajectory | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CutRun:
    """A run that broke off.

    Attributes:
        memory: of the checkpoint.
        tick: of the tree, the next one.
        robots: by their names.
        past: what sinks are shown of the run before, given what they are told as it goes on.
    """

    memory: RunMemory
    tick: int
    robots: Mapping[str, Cut]
    past: Callable[[RunInfo], Iterable[TickSnapshot | Event]] = lambda _: ()

    @property
    def stamp_s(self) -> float:
        """Mission time at which it goes on."""
        return next(iter(self.robots.values())).resumption.stamp_s


def check_clock(driver: Driver, resumed: Resumption | None) -> None:
    """Refuse a driver that begins anew where it was to go on.

    Raises:
        UserError: its clock shows another mission time.
    """
    if resumed is not None and driver.clock.now_s() < resumed.stamp_s - _LATE_S:
        raise UserError(
            f"driver {driver.name} cannot go on at {resumed.stamp_s:.1f} s of mission time, its clock begins "
            f"at {driver.clock.now_s():.1f} s: its runs cannot be resumed; run the mission anew"
        )

"""A map from a recorded log: measurements into SLAM as fast as it takes them, no robot, no tree."""

from __future__ import annotations

import re
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from explore_bt.errors import ComponentFailure, ExploreError, LogCutOff, LogError
from explore_bt.interfaces import Playback, Slam
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.types import Battery, Health, Measurement, PointCloud, Scan2D, Trajectory, WheelOdometry

__all__ = ["HealthChange", "Mapping", "map_log"]

_LONGEST_REASON = 200
_NUMBERS = re.compile(r"[\d.]+")


@dataclass(frozen=True, slots=True)
class HealthChange:
    """From ``stamp_s`` on (mission time) SLAM trusted itself so far, for this reason."""

    stamp_s: float
    state: Health
    reason: str


@dataclass(slots=True)
class Mapping:
    """What became of a log.

    Attributes:
        scans: 2D and 3D scans given to SLAM.
        duration_s: mission time of the last measurement.
        milliseconds: of each scan, in SLAM's ``update``, by the wall's clock.
        health: every change of state, or of the reason apart from the figures in it.
        damage: empty, or how the log is cut off, or how SLAM failed; ``fault`` is the exception.
    """

    scans: int = 0
    duration_s: float = 0.0
    milliseconds: list[float] = field(default_factory=list)
    health: list[HealthChange] = field(default_factory=list)
    held: Counter[str] = field(default_factory=Counter)
    damage: str = ""
    fault: ExploreError | None = None
    _log_stamps_s: dict[float, float] = field(default_factory=dict)

    def in_log_time(self, trajectory: Trajectory) -> Trajectory:
        """A trajectory of this run with the log's own stamps, by which others know its scans."""
        stamps = (self._log_stamps_s.get(stamp_s, stamp_s) for stamp_s in trajectory.stamps_s.tolist())
        return Trajectory(np.fromiter(stamps, dtype=np.float64), trajectory.poses)

    def percentile_ms(self, percent: float) -> float:
        """Milliseconds that so many percent of the scans stayed under."""
        return float(np.percentile(self.milliseconds, percent)) if self.milliseconds else 0.0


def map_log(
    playback: Playback,
    slam: Slam,
    *,
    odometry: bool,
    stop: StopFlag,
    on_scan: Callable[[Mapping], None] = lambda _: None,
) -> Mapping:
    """Give a whole log to a SLAM that is set up.

    Args:
        playback: where the measurements come from.
        slam: what takes them.
        odometry: whether it is told what the wheels say.
        stop: raised by anyone who wants an end; what has been mapped so far stays.
        on_scan: called after each scan, for a progress bar.

    Raises:
        LogError: something in the log cannot be understood, or there is not one scan in it. (A log that is
            cut off is no error where scans came before: ``damage`` says so.)
        ComponentFailure: SLAM raised at the first scan. (Later on ``damage`` says so.)
    """
    mapping = Mapping()
    try:
        for recorded in playback.recorded():
            if stop.is_raised:
                break
            measurement = recorded.measurement
            mapping.held[f"{type(measurement).__name__} {measurement.frame}"] += 1
            mapping.duration_s = measurement.stamp_s
            if isinstance(measurement, Scan2D | PointCloud):
                mapping._log_stamps_s[measurement.stamp_s] = recorded.log_stamp_s
                begun_s = time.perf_counter()
                _update(slam, measurement)
                mapping.milliseconds.append(1000.0 * (time.perf_counter() - begun_s))
                mapping.scans += 1
                _note_health(mapping, slam)
                on_scan(mapping)
            elif not isinstance(measurement, Battery) and (
                odometry or not isinstance(measurement, WheelOdometry)
            ):
                _update(slam, measurement)
    except (LogCutOff, ComponentFailure) as end:
        if not mapping.scans:
            raise
        mapping.damage, mapping.fault = str(end), end
    if not mapping.scans and not stop.is_raised:
        held = ", ".join(sorted(mapping.held)) or "nothing"
        raise LogError(f"not one scan in the log to make a map of; it holds {held}")
    return mapping


def _update(slam: Slam, measurement: Measurement) -> None:
    try:
        slam.update(measurement)
    except Exception as fault:  # whatever a plugin does, what it has mapped so far is kept
        words = " ".join(f"{type(fault).__name__}: {fault}".split())
        raise ComponentFailure(f"slam {slam.name}", words[:_LONGEST_REASON]) from fault


def _note_health(mapping: Mapping, slam: Slam) -> None:
    estimate = slam.estimate()
    new = HealthChange(mapping.duration_s, estimate.health, estimate.reason)
    last = mapping.health[-1] if mapping.health else None
    if last is None or (last.state, _NUMBERS.sub("", last.reason)) != (
        new.state,
        _NUMBERS.sub("", new.reason),
    ):
        mapping.health.append(new)

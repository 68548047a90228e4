from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from explore_bt.errors import ComponentFailure, LogCutOff, LogError
from explore_bt.interfaces import API_VERSION, Playback, PluginOptions, Recorded, Slam
from explore_bt.runtime import StopFlag, map_log
from explore_bt.types import (
    UNKNOWN,
    Estimate,
    Health,
    Imu,
    Measurement,
    OccupancyGrid,
    Pose2,
    Scan2D,
    Trajectory,
    WheelOdometry,
)

OLD_S = 500.0


def scan(stamp_s: float) -> Scan2D:
    one = np.ones(1)
    return Scan2D(stamp_s, one, one.astype(np.float32), np.zeros(1), 0.1, 5.0)


class Tape(Playback):
    """Plays these measurements, then raises what it is told to."""

    def __init__(self, *measurements: Measurement, end: Exception | None = None) -> None:
        self._measurements, self._end = measurements, end

    def recorded(self) -> Iterator[Recorded]:
        for measurement in self._measurements:
            yield Recorded(measurement, measurement.stamp_s + OLD_S)
        if self._end is not None:
            raise self._end

    @property
    def progress(self) -> float:
        return 1.0

    @property
    def notes(self) -> Sequence[str]:
        return ()


class Listener(Slam):
    """Keeps what it hears; its health is scripted, one state a scan."""

    name = "listener"
    api_version = API_VERSION

    def __init__(self, *states: tuple[Health, str]) -> None:
        super().__init__(PluginOptions())
        self.heard: list[Measurement] = []
        self.states = list(states)

    def setup(self, context):
        pass

    def update(self, measurement):
        self.heard.append(measurement)

    def estimate(self):
        count = sum(isinstance(each, Scan2D) for each in self.heard)
        health, reason = self.states[count - 1] if self.states else (Health.OK, "")
        return Estimate(self.heard[-1].stamp_s, Pose2.identity(), health=health, reason=reason)

    def grid(self):
        return OccupancyGrid(np.full((1, 1), UNKNOWN, dtype=np.int8), 0.05, (0.0, 0.0))

    def changed_since(self, revision):
        return None

    def trajectory(self):
        stamps = [each.stamp_s for each in self.heard if isinstance(each, Scan2D)]
        return Trajectory(np.array(stamps), np.zeros((len(stamps), 3)))

    def figures(self):
        return {}

    def save(self, folder):
        pass

    def load(self, folder):
        pass


DRIVE = (
    WheelOdometry(0.0, Pose2.identity()),
    scan(0.0),
    Imu(0.5, (0, 0, 0), (0, 0, 9.8)),
    WheelOdometry(1.0, Pose2.identity()),
    scan(1.0),
)


@pytest.mark.parametrize(("odometry", "heard"), [(False, 3), (True, 5)])
def test_the_wheels_are_heard_only_where_asked_for(odometry, heard):
    slam = Listener()
    mapping = map_log(Tape(*DRIVE), slam, odometry=odometry, stop=StopFlag())
    assert len(slam.heard) == heard
    assert (mapping.scans, mapping.duration_s, len(mapping.milliseconds)) == (2, 1.0, 2)
    assert mapping.held == {"WheelOdometry odom": 2, "Scan2D laser": 2, "Imu base_link": 1}


def test_the_trajectory_is_told_in_the_logs_own_stamps():
    slam = Listener()
    mapping = map_log(Tape(*DRIVE), slam, odometry=False, stop=StopFlag())
    assert mapping.in_log_time(slam.trajectory()).stamps_s.tolist() == [OLD_S, OLD_S + 1.0]


def test_health_is_noted_when_it_changes_and_not_when_its_figures_do():
    states = [
        (Health.OK, ""),
        (Health.OK, ""),
        (Health.DEGRADED, "only 30% fits"),
        (Health.DEGRADED, "only 20% fits"),
        (Health.LOST, "only 20% fits"),
        (Health.OK, ""),
    ]
    mapping = map_log(Tape(*map(scan, range(6))), Listener(*states), odometry=False, stop=StopFlag())
    assert [(each.stamp_s, str(each.state), each.reason) for each in mapping.health] == [
        (0.0, "ok", ""),
        (2.0, "degraded", "only 30% fits"),
        (4.0, "lost", "only 20% fits"),
        (5.0, "ok", ""),
    ]


def test_a_raised_flag_ends_it_and_keeps_what_there_is():
    stop = StopFlag()
    mapping = map_log(
        Tape(*map(scan, range(9))),
        Listener(),
        odometry=False,
        stop=stop,
        on_scan=lambda so_far: stop.raise_flag("enough") if so_far.scans == 4 else None,
    )
    assert mapping.scans == 4


def test_a_cut_log_counts_as_far_as_it_goes():
    mapping = map_log(Tape(scan(0.0), end=LogCutOff("cut")), Listener(), odometry=False, stop=StopFlag())
    assert (mapping.scans, mapping.damage) == (1, "cut")


class Stumbling(Listener):
    """Raises at the third scan."""

    def update(self, measurement):
        super().update(measurement)
        if len(self.heard) == 3:
            raise ValueError("singular\n  matrix")


def test_a_slam_that_raises_keeps_what_it_has_mapped():
    mapping = map_log(Tape(*map(scan, range(5))), Stumbling(), odometry=False, stop=StopFlag())
    assert (mapping.scans, mapping.damage) == (2, "slam listener: ValueError: singular matrix")
    assert isinstance(mapping.fault, ComponentFailure)


def test_a_slam_that_raises_at_once_is_a_failure_of_that_plugin():
    slam = Stumbling()
    slam.heard = [scan(0.0), scan(0.1)]
    with pytest.raises(ComponentFailure, match="slam listener"):
        map_log(Tape(scan(0.2)), slam, odometry=False, stop=StopFlag())


@pytest.mark.parametrize(
    ("tape", "message"),
    [
        (Tape(end=LogCutOff("cut before the first scan")), "cut before the first scan"),
        (Tape(scan(0.0), end=LogError("nonsense")), "nonsense"),
        (Tape(DRIVE[0]), "not one scan in the log to make a map of; it holds WheelOdometry odom"),
        (Tape(), "it holds nothing"),
    ],
)
def test_a_log_that_makes_no_map_is_told(tape, message):
    with pytest.raises(LogError, match=message):
        map_log(tape, Listener(), odometry=False, stop=StopFlag())

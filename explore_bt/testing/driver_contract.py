"""The contract of drivers as tests: subclass, say how to make yours, run pytest.

::

    from explore_bt.testing.driver_contract import DriverContract

    class TestMyDriver(DriverContract):
        def make(self, tmp_path):
            return MyDriver(MyDriver.Options(port="/dev/ttyUSB0"))

Each test sets up a driver of its own in free space, drives slowly for a second or two, and closes it.
A driver that plays a recording (``explore_bt.interfaces.Playback``) obeys nobody: what is asked of commands
is skipped for it.
"""

from __future__ import annotations

import itertools
import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from explore_bt.interfaces import API_VERSION, Commons, Driver, Playback, RobotContext
from explore_bt.types import (
    Imu,
    Measurement,
    PointCloud,
    Pose2,
    RgbdFrame,
    Scan2D,
    Twist2,
    WheelOdometry,
    wrap_angle,
)

__all__ = ["DriverContract"]

_PERIOD_S = 0.05
_STAMP_SLACK_S = 1e-6


class DriverContract(ABC):
    """Tests that every driver passes; their names and messages say what is asked of it.

    Attributes:
        context: given to ``setup``; override it to place the robot where it has 0.5 m of free way ahead.
        speed_mps: of the drives in these tests; must be within the driver's limits.
    """

    context = RobotContext(seed=7)
    speed_mps = 0.15

    @abstractmethod
    def make(self, tmp_path: Path) -> Driver:
        """A new driver, not set up yet."""

    def test_construction_is_cheap_and_names_the_plugin(self, tmp_path: Path) -> None:
        """Missions are checked and drawn without a robot."""
        driver = self.make(tmp_path)
        assert driver.kind == "driver", f"kind is {driver.kind!r}; subclass explore_bt.interfaces.Driver"
        assert driver.name.isidentifier(), f"name {driver.name!r} is what missions write after 'use:'"
        assert driver.api_version == API_VERSION, (
            f"written for API version {driver.api_version}, this is {API_VERSION}"
        )
        assert isinstance(driver.options, type(driver).Options), "options are not of the class's Options"

    def test_properties_are_valid_after_setup(self, tmp_path: Path) -> None:
        """Limits, footprint, start and clock make sense."""
        with self._ready(tmp_path) as driver:
            assert driver.footprint_radius_m > 0.0, "footprint_radius_m must be above 0"
            limits = driver.limits
            for name in limits.__dataclass_fields__:
                value = getattr(limits, name)
                assert math.isfinite(value), f"limits.{name} is {value}; give a finite number"
                assert value > 0.0, f"limits.{name} is {value}; a limit is above 0"
            assert np.isfinite(driver.start.as_array()).all(), f"start is {driver.start}"
            assert driver.clock.now_s() >= 0.0, "the clock counts seconds from the start of the mission"

    def test_the_given_start_is_kept(self, tmp_path: Path) -> None:
        """``start`` is ``context.start`` where there is one."""
        with self._ready(tmp_path) as driver:
            if self.context.start is not None:
                assert driver.start == self.context.start, (
                    f"start is {driver.start}, the mission said {self.context.start}"
                )

    def test_clock_waits_as_long_as_it_is_told(self, tmp_path: Path) -> None:
        """After ``wait_until(t)`` it is t or later, and waiting for the past returns at once."""
        with self._ready(tmp_path) as driver:
            clock = driver.clock
            before = clock.now_s()
            clock.wait_until(before + 0.1)
            now = clock.now_s()
            assert now >= before + 0.1, f"wait_until came back {before + 0.1 - now:.3f} s early"
            clock.wait_until(before)
            assert clock.now_s() >= now, "the clock went back"

    def test_read_gives_each_measurement_once(self, tmp_path: Path) -> None:
        """A second ``read`` without waiting has nothing left."""
        with self._ready(tmp_path) as driver:
            self._hold(driver, 1.0)
            first = driver.read()
            assert first, "a second after setup read() has measured nothing"
            again = driver.read()
            if driver.clock.is_simulated:
                assert not again, f"read() gave {len(again)} measurements again without time passing"

    def test_stamps_are_in_order_and_not_ahead_of_the_clock(self, tmp_path: Path) -> None:
        """Measurements come in time order, within one call and from call to call."""
        with self._ready(tmp_path) as driver:
            last = -math.inf
            for measured, now in self._drive(driver, Twist2(self.speed_mps, 0.0), 1.0):
                for measurement in measured:
                    stamp = measurement.stamp_s
                    what = f"read() returned {_noun(measurement)} stamped {stamp:.3f} s"
                    assert stamp >= last, f"{what} after one of {last:.3f} s"
                    assert stamp <= now + _STAMP_SLACK_S, f"{what}, {stamp - now:.3f} s after the clock"
                    last = stamp

    def test_scans_are_well_formed(self, tmp_path: Path) -> None:
        """Shapes, dtypes, beam times; NaN is invalid, +inf is nothing within range."""
        with self._ready(tmp_path) as driver:
            self._hold(driver, 1.0)
            measured = driver.read()
            if not any(isinstance(found, Scan2D | PointCloud) for found in measured):
                pytest.fail("a second after setup no scan has come: no SLAM can work with this driver")
            for measurement in measured:
                if isinstance(measurement, Scan2D):
                    _check_scan(measurement)
                elif isinstance(measurement, PointCloud):
                    _check_cloud(measurement)

    def test_inertial_samples_are_finite_and_feel_gravity(self, tmp_path: Path) -> None:
        """rad/s and m/s² in base_link axes; a level robot at rest feels +9.8 m/s² along z."""
        with self._ready(tmp_path) as driver:
            self._hold(driver, 1.0)
            samples = [found for found in driver.read() if isinstance(found, Imu)]
            if not samples:
                pytest.skip("this driver has no IMU")
            values = np.array([(*s.angular_velocity_rps, *s.linear_acceleration_mps2) for s in samples])
            assert np.isfinite(values).all(), "an IMU sample is not finite"
            up = float(np.median(values[:, 5]))
            assert 8.8 < up < 10.8, f"at rest the accelerometer's z is {up:.2f}; expected +9.8 m/s² (up is +)"

    def test_command_moves_the_robot_forward(self, tmp_path: Path) -> None:
        """A positive linear speed drives along the robot's own x."""
        with self._ready(tmp_path) as driver:
            moved = self._motion_of(driver, Twist2(self.speed_mps, 0.0), 2.0)
            longest = self.speed_mps * 2.0 * 1.2
            assert moved.x > 0.2 * longest, (
                f"2 s at {self.speed_mps} m/s moved the robot {moved.x:.3f} m ahead"
            )
            assert moved.x < longest, f"2 s at {self.speed_mps} m/s moved the robot {moved.x:.3f} m: too far"

    def test_a_positive_turn_is_counter_clockwise(self, tmp_path: Path) -> None:
        """REP-103: angular_rps > 0 turns left."""
        with self._ready(tmp_path) as driver:
            turned = self._motion_of(driver, Twist2(0.0, 0.3), 2.0).yaw_rad
            assert 0.1 < turned < 0.75, f"2 s at 0.3 rad/s turned the robot by {turned:.2f} rad"

    def test_stop_halts_and_stays_in_force(self, tmp_path: Path) -> None:
        """After a stop the robot is at rest, however often and from wherever it was called."""
        with self._ready(tmp_path) as driver:
            self._run(driver, Twist2(self.speed_mps, 0.2), 1.0)
            driver.stop()
            driver.stop()
            self._hold(driver, 2.0)
            self._assert_rest(driver, "2 s after stop()")

    def test_stop_may_come_from_another_thread(self, tmp_path: Path) -> None:
        """A signal handler or a web page stops the robot too."""
        with self._ready(tmp_path) as driver:
            self._run(driver, Twist2(self.speed_mps, 0.0), 1.0)
            caught: list[BaseException] = []

            def stop() -> None:
                try:
                    driver.stop()
                except BaseException as error:  # the contract: never raises
                    caught.append(error)

            thread = threading.Thread(target=stop)
            thread.start()
            thread.join(5.0)
            assert not thread.is_alive(), "stop() from another thread did not return within 5 s"
            assert not caught, f"stop() from another thread raised {caught[0]!r}"
            self._hold(driver, 2.0)
            self._assert_rest(driver, "2 s after stop() from another thread")

    def test_a_command_after_a_stop_moves_again(self, tmp_path: Path) -> None:
        """A stop lasts until the next command, not for ever."""
        with self._ready(tmp_path) as driver:
            driver.stop()
            self._hold(driver, 0.2)
            moved = self._motion_of(driver, Twist2(self.speed_mps, 0.0), 2.0)
            assert moved.x > 0.02, "after stop() the robot no longer obeys command()"

    def test_the_watchdog_stops_a_robot_nobody_commands(self, tmp_path: Path) -> None:
        """Half a second after the last command the driver halts by itself."""
        with self._ready(tmp_path) as driver:
            self._run(driver, Twist2(self.speed_mps, 0.0), 1.0)
            self._hold(driver, 2.5)
            self._assert_rest(driver, "2.5 s after the last command")

    def test_limits_hold_whatever_is_commanded(self, tmp_path: Path) -> None:
        """A command far beyond the limits is cut, not obeyed."""
        with self._ready(tmp_path) as driver:
            limits = driver.limits
            truth = driver.truth()
            if truth is None:
                pytest.skip("only a simulator's truth can show this")
            wild = Twist2(10.0 * limits.speed_mps, 10.0 * limits.turn_rate_rps)
            poses = [truth.pose(), *(truth.pose() for _ in self._drive(driver, wild, 1.0))]
            for a, b in itertools.pairwise(poses):
                speed, rate = a.distance_to(b) / _PERIOD_S, abs(a.between(b).yaw_rad) / _PERIOD_S
                assert speed <= 1.01 * limits.speed_mps, f"drove {speed:.2f} m/s, over {limits.speed_mps}"
                assert rate <= 1.01 * limits.turn_rate_rps, f"turned {rate:.2f} rad/s, over the limit"

    def test_close_is_idempotent_and_stop_after_it_is_harmless(self, tmp_path: Path) -> None:
        """Everything is let go of once; a late stop flag does no harm."""
        driver = self.make(tmp_path)
        driver.setup(replace(self.context, commons=Commons()))  # every driver in a mission of its own
        driver.close()
        driver.close()
        driver.stop()

    def test_stop_and_close_before_setup_are_harmless(self, tmp_path: Path) -> None:
        """Set-up of another robot may fail before this one's begins."""
        driver = self.make(tmp_path)
        driver.stop()
        driver.close()

    def test_a_simulated_run_repeats_bit_for_bit(self, tmp_path: Path) -> None:
        """Same seed, same commands: the same measurements."""
        with self._ready(tmp_path) as one, self._ready(tmp_path) as other:
            if not one.clock.is_simulated:
                pytest.skip("real time does not repeat")
            first, second = (
                [
                    found
                    for batch, _ in self._drive(driver, Twist2(self.speed_mps, 0.1), 1.0)
                    for found in batch
                ]
                for driver in (one, other)
            )
            assert [_fingerprint(found) for found in first] == [_fingerprint(found) for found in second], (
                "two runs with the same seed measured different things: draw from context.rng only"
            )

    @contextmanager
    def _ready(self, tmp_path: Path) -> Iterator[Driver]:
        driver = self.make(tmp_path)
        driver.setup(replace(self.context, commons=Commons()))  # every driver in a mission of its own
        try:
            yield driver
        finally:
            driver.close()

    def _drive(
        self, driver: Driver, twist: Twist2, duration_s: float
    ) -> Iterator[tuple[Sequence[Measurement], float]]:
        """Command at 20 Hz; after each period, what was read and the time."""
        begin = driver.clock.now_s()
        for period in range(1, round(duration_s / _PERIOD_S) + 1):
            driver.command(twist)
            driver.clock.wait_until(begin + period * _PERIOD_S)
            measured = driver.read()
            yield measured, driver.clock.now_s()

    def _run(self, driver: Driver, twist: Twist2, duration_s: float) -> list[Measurement]:
        return [found for measured, _ in self._drive(driver, twist, duration_s) for found in measured]

    def _hold(self, driver: Driver, duration_s: float) -> None:
        driver.clock.wait_until(driver.clock.now_s() + duration_s)

    def _motion_of(self, driver: Driver, twist: Twist2, duration_s: float) -> Pose2:
        """How the robot moved, seen from where it was: by the truth, else by its wheels."""
        _skip_a_recording(driver)
        truth = driver.truth()
        before = truth.pose() if truth else self._wheels(driver)
        measured = self._run(driver, twist, duration_s)
        after = truth.pose() if truth else _last_wheels(measured)
        return before.between(after)

    def _wheels(self, driver: Driver) -> Pose2:
        self._hold(driver, 0.5)
        return _last_wheels(driver.read())

    def _assert_rest(self, driver: Driver, when: str) -> None:
        _skip_a_recording(driver)
        truth = driver.truth()
        before = truth.pose() if truth else self._wheels(driver)
        self._hold(driver, 0.5)
        after = truth.pose() if truth else _last_wheels(driver.read())
        moved, turned = before.distance_to(after), wrap_angle(after.yaw_rad - before.yaw_rad)
        assert moved < 0.002, f"{when} the robot still moves: {moved * 100:.1f} cm in half a second"
        assert abs(turned) < 0.005, f"{when} the robot still turns: {turned:.3f} rad in half a second"


def _skip_a_recording(driver: Driver) -> None:
    if isinstance(driver, Playback):
        pytest.skip("a recording was driven already: it obeys no command")


def _last_wheels(measured: Sequence[Measurement]) -> Pose2:
    poses = [found.T_odom_base for found in measured if isinstance(found, WheelOdometry)]
    if not poses:
        pytest.skip("neither truth nor wheel odometry can show how the robot moves")
    return poses[-1]


def _check_scan(scan: Scan2D) -> None:
    count = len(scan.ranges_m)
    assert scan.ranges_m.dtype == np.float32, f"ranges_m is {scan.ranges_m.dtype}; expected float32"
    for name in ("angles_rad", "times_s"):
        values = getattr(scan, name)
        assert values.dtype == np.float64, f"{name} is {values.dtype}; expected float64"
        assert values.shape == (count,), f"{name} has shape {values.shape} for {count} ranges"
        assert np.isfinite(values).all(), f"{name} is not finite everywhere"
    assert (scan.times_s <= 0.0).all(), "times_s are relative to the stamp of the last beam: none is above 0"
    assert (scan.times_s > -10.0).all(), "times_s are relative to stamp_s, not absolute"
    finite = scan.ranges_m[np.isfinite(scan.ranges_m)]
    assert not np.isneginf(scan.ranges_m).any(), "a range is -inf; an invalid return is NaN"
    assert (finite > 0.0).all(), "a range is 0 or below; an invalid return is NaN"
    over = finite[finite > scan.range_max_m]
    assert len(over) == 0, f"a range of {over.max() if len(over) else 0:.2f} m exceeds range_max_m: give +inf"


def _check_cloud(cloud: PointCloud) -> None:
    assert cloud.points.dtype == np.float32, f"points are {cloud.points.dtype}; expected float32"
    assert cloud.points.ndim == 2, f"points have shape {cloud.points.shape}; expected (N, 3)"
    assert cloud.points.shape[1] == 3, f"points have shape {cloud.points.shape}; expected (N, 3)"
    assert cloud.times_s.shape == (len(cloud.points),), "times_s gives one time per point"
    assert (cloud.times_s <= 0.0).all(), "times_s are relative to the stamp of the last point"
    assert cloud.T_base_sensor.shape == (4, 4), "T_base_sensor is (4, 4)"


def _noun(measurement: Measurement) -> str:
    return {Scan2D: "a scan", Imu: "an IMU sample", PointCloud: "a cloud", RgbdFrame: "an image"}.get(
        type(measurement), "wheel odometry"
    )


def _fingerprint(measurement: Measurement) -> tuple[object, ...]:
    if isinstance(measurement, Scan2D):
        return ("scan", measurement.stamp_s, measurement.ranges_m.tobytes(), measurement.times_s.tobytes())
    if isinstance(measurement, PointCloud):
        return ("cloud", measurement.stamp_s, measurement.points.tobytes(), measurement.times_s.tobytes())
    if isinstance(measurement, RgbdFrame):
        return ("image", measurement.stamp_s, measurement.image.tobytes(), measurement.depth_m.tobytes())
    return (repr(measurement),)

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import Controller, ControlOutput, ControlStatus, Driver, HeldBy, Surroundings
from explore_bt.runtime.pilot import Pilot
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.testing.fake_robot import full_circle_scan, open_floor
from explore_bt.types import (
    BodyFault,
    BodyFaultKind,
    Estimate,
    MotionLimits,
    MotionState,
    Path,
    Pose2,
    Twist2,
)

from .conftest import DT, LIMITS, towards

FLOOR = open_floor()
POST = np.array([[0.25, 0.0]])


class StraightOn:
    """Sets off gently, whatever comes; counts how often it was asked."""

    def __init__(self) -> None:
        self.asked = 0

    def follow(self, path: Path) -> None:
        """Every path is as good."""

    def see(self, surroundings: Surroundings) -> None:
        """It does not look."""

    def step(self, *_: object) -> ControlOutput:
        self.asked += 1
        return ControlOutput(Twist2(0.01, 0.0), ControlStatus.RUNNING)


class Off(StraightOn):
    """Wants half a metre a second, under the usual limits."""

    def step(self, estimate: object, scan: object, motion: MotionState, dt_s: float) -> ControlOutput:
        return ControlOutput(towards(Twist2(0.5, 0.0), motion), ControlStatus.RUNNING)


class Steady(StraightOn):
    """Goes on at 0.2 m/s."""

    def step(self, *_: object) -> ControlOutput:
        return ControlOutput(Twist2(0.2, 0.0), ControlStatus.RUNNING)


class Wheels:
    command_delay_s = 0.0
    command_life_s = 0.0
    fault: BodyFault | None = None

    def command(self, twist: Twist2) -> None:
        """Nothing hangs on it."""

    def hindrance(self) -> str:
        return ""


@pytest.fixture
def pilot() -> Pilot:
    return Pilot(
        cast(Controller, StraightOn()),
        SafetyGate(0.25, MotionLimits()),
        cast(Driver, Wheels()),
        MotionLimits(),
    )


def show(pilot: Pilot, stamp_s: float, pose: Pose2, points: np.ndarray) -> Estimate:
    estimate = Estimate(stamp_s, pose)
    pilot.see(Surroundings(0.0, points, FLOOR), estimate)
    return estimate


def test_old_scans_still_hold_the_robot_while_the_pose_runs_on_smoothly(pilot: Pilot) -> None:
    for i in range(15):
        estimate = show(pilot, 0.1 * i, Pose2(0.002 * i, 0.0, 0.0), POST)
    estimate = show(pilot, 1.5, Pose2(0.03, 0.0, 0.0), np.zeros((0, 2)))
    pilot.step(estimate, replace(full_circle_scan(), stamp_s=1.5), 1.5, DT)
    assert "obstacle in the last 15 scans" in pilot.gate_reason


@pytest.mark.parametrize("jump", [Pose2(0.0, 0.05, 0.0), Pose2(0.0, 0.0, 0.08)])
def test_scans_from_before_a_corrected_pose_are_forgotten(pilot: Pilot, jump: Pose2) -> None:
    for i in range(15):
        show(pilot, 0.1 * i, Pose2(0.0, 0.0, 0.0), POST)
    estimate = show(pilot, 1.5, jump, np.zeros((0, 2)))
    pilot.step(estimate, replace(full_circle_scan(), stamp_s=1.5), 1.5, DT)
    assert pilot.gate_reason == ""


@pytest.mark.parametrize(("age_s", "fault"), [(0.3, ""), (1.2, "the newest estimate is 1.2 s old")])
def test_an_estimate_may_be_late_but_not_old(pilot: Pilot, age_s: float, fault: str) -> None:
    estimate = show(pilot, 5.0, Pose2(0.0, 0.0, 0.0), np.zeros((0, 2)))
    now_s = 5.0 + age_s
    pilot.step(estimate, replace(full_circle_scan(), stamp_s=now_s), now_s, DT)
    assert pilot.gate_reason == fault
    assert pilot.held_by is (HeldBy.SENSES if fault else HeldBy.NOTHING)


def drive(pilot: Pilot, steps: range) -> None:
    for i in steps:
        estimate = show(pilot, DT * i, Pose2(0.0, 0.0, 0.0), np.zeros((0, 2)))
        pilot.step(estimate, replace(full_circle_scan(), stamp_s=DT * i), DT * i, DT)


def test_a_pause_brakes_to_rest_and_the_path_is_gone_on_with(pilot: Pilot) -> None:
    path = Path(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), np.array([1.0, 1.0]))
    controller = cast(StraightOn, pilot._controller)
    pilot.follow(path)
    drive(pilot, range(40))
    asked = controller.asked
    speeds = []
    for i in range(40, 100):
        pilot.pause("held by the debugger", DT * i, DT)
        speeds.append(pilot.motion.twist.linear_mps)
    assert speeds == sorted(speeds, reverse=True)
    assert pilot.is_at_rest
    assert (pilot.path, pilot.output.status, controller.asked) == (path, ControlStatus.RUNNING, asked)
    assert (pilot.gate_reason, pilot.held_by) == ("held by the debugger", HeldBy.DEBUGGER)
    drive(pilot, range(100, 110))
    assert (pilot.held_by, pilot.is_at_rest) == (HeldBy.NOTHING, False)


def test_a_pause_does_not_count_as_being_blocked(pilot: Pilot) -> None:
    for i in range(15):
        show(pilot, 0.1 * i, Pose2(0.0, 0.0, 0.0), POST)
    for time_s in (1.5, 1.6):
        estimate = show(pilot, time_s, Pose2(0.0, 0.0, 0.0), POST)
        pilot.step(estimate, replace(full_circle_scan(), stamp_s=time_s), time_s, DT)
    before_s = pilot.blocked_s
    for i in range(1, 200):
        pilot.pause("held", 1.6 + DT * i, DT)
    assert pilot.blocked_s == pytest.approx(before_s)
    assert before_s > 0.0


def test_a_body_that_cannot_drive_is_held_and_named(pilot: Pilot) -> None:
    wheels = cast(Wheels, pilot._driver)
    wheels.fault = BodyFault(BodyFaultKind.FALLEN, "the robot has fallen")
    pilot.step(Estimate(0.0, Pose2(0.0, 0.0, 0.0)), full_circle_scan(), 0.0, DT)
    assert pilot.held_by is HeldBy.BODY
    assert pilot.gate_reason == "the robot has fallen"
    assert pilot.motion.twist == Twist2()


@given(st.integers(5, 60), st.integers(1, 12))
@settings(deadline=None, max_examples=60)
def test_a_brake_firmer_than_the_drive_keeps_its_own_limits_and_never_rolls_back(
    before: int, held: int
) -> None:
    firm = replace(LIMITS, acceleration_mps2=2.5, jerk_mps3=30.0)
    pilot = Pilot(cast(Controller, Off()), SafetyGate(0.25, firm), cast(Driver, Wheels()), LIMITS)
    blind = replace(full_circle_scan(), ranges_m=np.full(360, np.nan, dtype=np.float32))
    speeds, held_at = [0.0], []
    for i in range(before + held + 60):
        is_held = before <= i < before + held
        estimate = show(pilot, DT * i, Pose2(0.0, 0.0, 0.0), np.zeros((0, 2)))
        scan = replace(blind if is_held else full_circle_scan(), stamp_s=DT * i)
        pilot.step(estimate, scan, DT * i, DT)
        speeds.append(pilot.motion.twist.linear_mps)
        held_at.append(is_held)
    accelerations = np.diff(speeds) / DT
    jerks = np.diff(accelerations) / DT
    assert min(speeds) > -0.002
    assert np.abs(accelerations).max() <= 2.5 + 1e-6
    assert np.abs(jerks).max() <= 30.0 + 1e-6
    let_go = before + held + 2
    assert min(speeds[let_go:]) > speeds[let_go] - 0.5**2 / (2.0 * 2.0)  # what levelling off costs


def test_a_command_that_may_stay_in_force_for_longer_is_checked_for_as_long(pilot: Pilot) -> None:
    wall = np.array([[0.6, 0.01 * n] for n in range(-60, 61)])
    limits = MotionLimits()

    def distance_at_hold(in_force_s: float) -> float:
        """How far ahead of a wall at x = 0.6 m a gate lets a robot of 0.25 m drive at 0.2 m/s."""
        gate = SafetyGate(0.25, limits)
        motion = MotionState(Twist2(0.2, 0.0))
        for x in np.arange(0.0, 0.3, 0.005):
            gate.see(Surroundings(0.0, wall - [x, 0.0], FLOOR), Pose2(0.0, 0.0, 0.0))
            if gate.decide(Twist2(0.2, 0.0), Pose2(0.0, 0.0, 0.0), motion, 0.05, 0.0, in_force_s).reason:
                return float(0.6 - x)
        raise AssertionError("never held")

    longer_m = distance_at_hold(0.25) - distance_at_hold(0.05)
    assert 0.2 * 0.2 - 0.006 <= longer_m <= 0.2 * 0.2 + 0.006


def test_a_command_that_a_driver_lets_live_on_is_checked_for_as_long() -> None:
    wall = np.array([[0.0, 0.01 * n] for n in range(-60, 61)])

    def distance_at_hold(life_s: float) -> float:
        """How far from a wall a robot that drives at 0.2 m/s is held."""
        for x in np.arange(0.6, 0.2, -0.005):
            wheels = Wheels()
            wheels.command_life_s = life_s
            pilot = Pilot(cast(Controller, Steady()), SafetyGate(0.25, LIMITS), cast(Driver, wheels), LIMITS)
            pilot.motion = MotionState(Twist2(0.2, 0.0))
            estimate = show(pilot, 0.0, Pose2(0.0, 0.0, 0.0), np.add(wall, [x, 0.0]))
            pilot.step(estimate, full_circle_scan(), 0.0, DT)
            if pilot.gate_reason:
                return float(x)
        raise AssertionError("never held")

    longer_m = distance_at_hold(DT + 0.2) - distance_at_hold(0.0)
    assert 0.2 * 0.2 - 0.006 <= longer_m <= 0.2 * 0.2 + 0.006

from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from explore_bt.interfaces import Controller, ControlOutput, ControlStatus, Driver, HeldBy, Surroundings
from explore_bt.runtime.pilot import Pilot
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.testing.fake_robot import full_circle_scan, open_floor
from explore_bt.types import Estimate, MotionLimits, Pose2, Twist2

FLOOR = open_floor()
DT = 0.05
POST = np.array([[0.25, 0.0]])


class StraightOn:
    """Sets off gently, whatever comes."""

    def see(self, surroundings: Surroundings) -> None:
        """It does not look."""

    def step(self, *_: object) -> ControlOutput:
        return ControlOutput(Twist2(0.01, 0.0), ControlStatus.RUNNING)


class Wheels:
    command_delay_s = 0.0

    def command(self, twist: Twist2) -> None:
        """Nothing hangs on it."""


@pytest.fixture
def pilot() -> Pilot:
    return Pilot(cast(Controller, StraightOn()), SafetyGate(0.25, MotionLimits()), cast(Driver, Wheels()))


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

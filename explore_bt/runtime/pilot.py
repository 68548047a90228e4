"""The way from a decision to the wheels: controller, safety gate, driver."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Controller, ControlOutput, ControlStatus, Driver, HeldBy, Surroundings
from explore_bt.runtime.pose_predictor import PosePredictor
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.types import (
    BodyFault,
    Estimate,
    Health,
    Mate,
    MotionLimits,
    MotionState,
    Path,
    Pose2,
    Scan2D,
    Twist2,
    way_along,
)

__all__ = ["Pilot"]

STALE_SCAN_S = 0.5
"""A scan older than this is no ground to drive on: five missed sweeps of a 10 Hz lidar."""
STALE_ESTIMATE_S = 1.0
"""An older one says little of here and now: the predictor knows the commands of two seconds only."""
FORGET = 0.99
"""Of what is added to a control period because periods have lately been late; gone after some seconds."""
JUMP_M = 0.03
JUMP_RAD = math.radians(3.0)
"""More than a body strays from its commands between two scans: the estimate was corrected."""

_REST = 1e-4
_AHEAD_M, _AHEAD_STEP_M = 8.0, 0.25
"""How much of its path a robot tells its team, and how finely."""


class Pilot:
    """Runs once per control period; every command passes the gate.

    Args:
        controller: asked for the next twist.
        gate: has the last word.
        driver: is sent it.
        limits: of the controller; the gate's brake may be harder.
    """

    def __init__(
        self, controller: Controller, gate: SafetyGate, driver: Driver, limits: MotionLimits
    ) -> None:
        self._controller = controller
        self._limits = limits
        self._gate = gate
        self._driver = driver
        self._predictor = PosePredictor(driver.command_delay_s)
        self.motion = MotionState()
        self.path: Path | None = None
        self.gate_reason = ""
        self._output = ControlOutput(Twist2(), ControlStatus.IDLE)
        self._blocked_since_s: float | None = None
        self.held_by = HeldBy.NOTHING
        self._now_s = 0.0
        self._in_force_s = 0.0
        self._shown: Estimate | None = None
        self._unseen: Surroundings | None = None

    @property
    def output(self) -> ControlOutput:
        """The controller's last word on the present path."""
        return self._output

    @property
    def blocked_s(self) -> float:
        """For how long the gate has been braking without a break, seconds."""
        return 0.0 if self._blocked_since_s is None else self._now_s - self._blocked_since_s

    @property
    def is_at_rest(self) -> bool:
        """Whether the last command was to stand still."""
        twist = self.motion.twist
        return abs(twist.linear_mps) < _REST and abs(twist.angular_rps) < _REST

    @property
    def body_fault(self) -> BodyFault | None:
        """Why the body cannot drive now; None while it can."""
        return self._driver.fault

    def recover_body(self) -> bool:
        """Have the body begin to get out of its fault; False where it cannot."""
        return self._driver.recover()

    @property
    def mates(self) -> tuple[Mate, ...]:
        """Team mates whose word is fresh; the gate keeps clear of where they stop."""
        return self._gate.mates

    @mates.setter
    def mates(self, mates: tuple[Mate, ...]) -> None:
        self._gate.mates = mates

    @property
    def in_the_way(self) -> str:
        """The name of the team mate that the robot was last held for."""
        return self._gate.in_the_way

    @property
    def is_following(self) -> bool:
        """Whether there is a path to go on along."""
        return self.path is not None and self._output.status is ControlStatus.RUNNING

    @property
    def stays_until_s(self) -> float:
        """The team has been told that the robot stays where it is until then; the gate keeps to it."""
        return self._gate.stays_until_s

    def stay(self, until_s: float) -> None:
        """The team will be told so."""
        self._gate.stays_until_s = max(self._gate.stays_until_s, until_s)

    def stop_places(self, here: Pose2, dt_s: float) -> NDArray[np.float64]:
        """(N, 2) metres, ``map`` frame: where the robot passes if it brakes after the coming period."""
        return self._gate.stop_places(self.motion, here, dt_s)

    def places_ahead(self, here: Pose2) -> NDArray[np.float64]:
        """(M, 2) metres: the next 8 m of the path; none without one."""
        if self.path is None or self._output.status is ControlStatus.ARRIVED:
            return np.empty((0, 2))
        xy = self.path.poses[:, :2]
        nearest = int(np.argmin(np.hypot(*(xy - here.xy).T)))
        along_m = way_along(self.path.poses[nearest:])
        stations = np.arange(0.0, min(along_m[-1], _AHEAD_M) + _AHEAD_STEP_M, _AHEAD_STEP_M)
        return np.column_stack([np.interp(stations, along_m, xy[nearest:, axis]) for axis in (0, 1)])

    def follow(self, path: Path) -> None:
        """Drive along ``path`` from the next control step on."""
        self.path = path
        self._output = ControlOutput(self._output.twist, ControlStatus.RUNNING)
        self._blocked_since_s = None
        self._controller.follow(path)

    def hold(self) -> None:
        """Come to rest under the limits."""
        self.path = None
        self._controller.hold()

    def see(self, surroundings: Surroundings, estimate: Estimate) -> None:
        """Show what is around the robot to controller and gate."""
        if self.has_jumped(estimate):
            self._gate.forget_scans()
        self._shown = estimate
        self._gate.see(surroundings, estimate.T_map_base)
        self._unseen = surroundings

    def has_jumped(self, estimate: Estimate) -> bool:
        """Whether the pose is elsewhere than the one shown last and the commands since then lead to."""
        if self._shown is None:
            return False
        expected = self._predictor.carry(self._shown, estimate.stamp_s).T_map_base
        off = expected.inverse().compose(estimate.T_map_base)
        return math.hypot(off.x, off.y) > JUMP_M or abs(off.yaw_rad) > JUMP_RAD

    def twist_at(self, time_s: float) -> Twist2:
        """What the body drove at a time of the last seconds, its lag behind its commands counted."""
        return self._predictor.twist_at(time_s)

    def carry(self, estimate: Estimate, time_s: float) -> Estimate:
        """The estimate carried forward to a time of the last seconds, the body's lag counted."""
        return self._predictor.carry(estimate, time_s)

    def predict(self, estimate: Estimate, now_s: float) -> Estimate:
        """Where all that was sent leads to, from the estimate."""
        return self._predictor.predict(estimate, now_s)

    def step(self, estimate: Estimate, scan: Scan2D | None, now_s: float, dt_s: float) -> None:
        """One control period: ask the controller, pass its wish through the gate, send the outcome.

        Args:
            estimate: the newest pose.
            scan: the newest scan.
            now_s: the time.
            dt_s: since the last command; the next may take as long as the longest of late, or as the driver
                lets the last one live.
        """
        self._now_s = now_s
        self._in_force_s = max(dt_s, self._driver.command_life_s, FORGET * self._in_force_s)
        now = self.predict(estimate, now_s)
        if self._unseen is not None:
            surroundings, self._unseen = self._unseen, None
            self._controller.see(surroundings)
        self._output = self._controller.step(now, scan, self._motion_within_limits(), dt_s)
        body = self.body_fault
        fault = body.reason if body else self._driver.hindrance() or _unfit_to_drive(estimate, scan, now_s)
        if fault:
            following, self.gate_reason = self._gate.brake(self.motion, dt_s), fault
            self.held_by = HeldBy.BODY if body else HeldBy.SENSES
        else:
            decision = self._gate.decide(
                self._output.twist, now.T_map_base, self.motion, dt_s, now_s, self._in_force_s
            )
            following, self.gate_reason = decision.motion, decision.reason
            self.held_by = decision.held_by
        if not self.gate_reason:
            self._blocked_since_s = None
        elif self._blocked_since_s is None:
            self._blocked_since_s = now_s
        self._send(following, now_s)

    def _motion_within_limits(self) -> MotionState:
        """What the controller goes on from: not what it could not have come to, nor could end before rest.

        A brake harder than its limits is let go of by the gate, whose jerk is the brake's.
        """
        limits, motion = self._limits, self.motion
        speed_mps, before = abs(motion.twist.linear_mps), motion.linear_acceleration_mps2
        most = limits.acceleration_mps2
        if before * motion.twist.linear_mps <= 0.0:
            most = min(most, math.sqrt(2.0 * limits.jerk_mps3 * speed_mps))
        return replace(motion, linear_acceleration_mps2=min(max(before, -most), most))

    def pause(self, reason: str, now_s: float, dt_s: float) -> None:
        """One control period at rest that the controller knows nothing of: the path is gone on with later."""
        if self._blocked_since_s is not None:
            self._blocked_since_s += now_s - self._now_s
        self.brake(reason, now_s, dt_s, HeldBy.DEBUGGER)

    def brake(self, reason: str, now_s: float, dt_s: float, held_by: HeldBy = HeldBy.SENSES) -> None:
        """One control period of a controlled stop, without asking the controller."""
        self._now_s = now_s
        self.gate_reason, self.held_by = reason, held_by
        self._send(self._gate.brake(self.motion, dt_s), now_s)

    def _send(self, following: MotionState, now_s: float) -> None:
        self._predictor.sent(now_s, self.motion, following)
        self.motion = following
        self._driver.command(following.twist)


def _unfit_to_drive(estimate: Estimate, scan: Scan2D | None, now_s: float) -> str:
    if estimate.health is Health.LOST:
        return f"SLAM is lost: {estimate.reason}"
    if scan is None:
        return "no scan yet"
    if bool(scan.is_invalid.all()):
        return "no beam of the newest scan is valid"
    if (age_s := now_s - scan.stamp_s) > STALE_SCAN_S:
        return f"the newest scan is {age_s:.1f} s old"
    if (age_s := now_s - estimate.stamp_s) > STALE_ESTIMATE_S:
        return f"the newest estimate is {age_s:.1f} s old"
    return ""

"""The running figures of one robot: distance, coverage, clearance, contacts, trajectory error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from explore_bt.exploration import ArgumentError, CoverageMeter, ate_rmse_m
from explore_bt.interfaces import GroundTruth
from explore_bt.types import MotionState, OccupancyGrid, Pose2, Score, Trajectory

__all__ = ["Scorekeeper"]

COVERAGE_PERIOD_S = 1.0


class Scorekeeper:
    """Watches one robot from outside; without a simulator's truth it counts what it can."""

    def __init__(self, home: Pose2, truth: GroundTruth | None) -> None:
        self._home = home
        self._truth = truth
        self._meter = CoverageMeter(truth.observable_floor()) if truth else None
        self._last_pose = home
        self._distance_m = 0.0
        self._coverage: float | None = None
        self._coverage_due_s = 0.0
        self._clearance_m: float | None = None
        self._min_clearance_m: float | None = None
        self._clearance_integral = 0.0
        self._last_true: Pose2 | None = truth.pose() if truth else None
        self._true_stamps: list[float] = []
        self._true_poses: list[tuple[float, float, float]] = []
        self._contacts = self._touched_by_people = 0
        """Of the processes before this one."""

    def control_step(self, pose: Pose2, sent: MotionState, now_s: float, dt_s: float) -> None:
        """Take note at every control step.

        Distance counts the true way where it is known, else what was commanded: summing estimates
        would count their noise as driving.
        """
        self._last_pose = pose
        if self._truth is None or self._last_true is None:
            self._distance_m += abs(sent.twist.linear_mps) * dt_s
            return
        true_pose = self._truth.pose()
        step_m = true_pose.distance_to(self._last_true)
        clearance_m = self._truth.clearance_m()
        self._last_true = true_pose
        self._distance_m += step_m
        self._clearance_m = clearance_m
        self._clearance_integral += clearance_m * step_m
        self._min_clearance_m = min(clearance_m, self._min_clearance_m or clearance_m)
        self._true_stamps.append(now_s)
        self._true_poses.append((true_pose.x, true_pose.y, true_pose.yaw_rad))

    def map_step(self, grid: OccupancyGrid, now_s: float, *, final: bool = False) -> None:
        """Measure coverage, once a second and at the end."""
        if self._meter and (final or now_s >= self._coverage_due_s):
            self._coverage = self._meter.measure(grid)
            self._coverage_due_s = now_s + COVERAGE_PERIOD_S

    def score(self) -> Score:
        """The figures now, without the trajectory error."""
        mean_m = self._clearance_m
        if self._truth and self._distance_m > 0.0:
            mean_m = self._clearance_integral / self._distance_m
        return Score(
            distance_m=self._distance_m,
            coverage=self._coverage,
            contacts=self._contacts + self._truth.contacts() if self._truth else None,
            touched_by_people=(
                self._touched_by_people + self._truth.touched_by_people() if self._truth else None
            ),
            clearance_m=self._clearance_m,
            min_clearance_m=self._min_clearance_m,
            mean_clearance_m=mean_m,
            distance_to_home_m=(self._last_true or self._last_pose).distance_to(self._home),
        )

    def memory(self) -> Mapping[str, object]:
        """Everything that a resumed run counts on from."""
        score = self.score()
        return {
            "distance_m": self._distance_m,
            "coverage": self._coverage,
            "min_clearance_m": self._min_clearance_m,
            "clearance_integral": self._clearance_integral,
            "contacts": score.contacts or 0,
            "touched_by_people": score.touched_by_people or 0,
            "true_stamps": tuple(self._true_stamps),
            "true_poses": tuple(self._true_poses),
        }

    def restore(self, memory: Mapping[str, Any]) -> None:
        """Count on from there."""
        self._distance_m, self._coverage = memory["distance_m"], memory["coverage"]
        self._min_clearance_m = memory["min_clearance_m"]
        self._clearance_integral = memory["clearance_integral"]
        self._contacts, self._touched_by_people = memory["contacts"], memory["touched_by_people"]
        self._true_stamps, self._true_poses = list(memory["true_stamps"]), list(memory["true_poses"])

    def catch_up(self, score: Score, true_way: Trajectory | None) -> None:
        """Count what was recorded after that memory was taken: the last score, and the true way since."""
        self._distance_m, self._coverage = score.distance_m, score.coverage
        self._min_clearance_m = score.min_clearance_m
        self._clearance_integral = (score.mean_clearance_m or 0.0) * score.distance_m
        self._contacts, self._touched_by_people = score.contacts or 0, score.touched_by_people or 0
        if true_way is not None:
            self._true_stamps += true_way.stamps_s.tolist()
            self._true_poses += [(x, y, yaw) for x, y, yaw in true_way.poses.tolist()]

    @property
    def true_pose(self) -> Pose2 | None:
        """The true pose at the last control step."""
        return self._last_true

    def true_trajectory(self) -> Trajectory | None:
        """The true way, one pose per control step; None without a simulator."""
        if not self._true_stamps:
            return None
        return Trajectory(np.array(self._true_stamps), np.array(self._true_poses))

    def ate_rmse_m(self, estimate: Trajectory) -> float | None:
        """Root mean square position error of ``estimate``; None without a simulator or a scan."""
        truth = self.true_trajectory()
        if truth is None:
            return None
        try:
            return ate_rmse_m(estimate, truth)
        except ArgumentError:  # a run too short for the two to overlap
            return None

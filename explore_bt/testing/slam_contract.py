"""What every SLAM plugin must do, as tests that its author inherits.

::

    class TestMySlam(SlamContract):
        def make(self):
            return MySlam(MySlam.Options())

No simulator is needed: the suite brings a small room with exact ranges and a scripted drive.
"""

# ruff: noqa: D102  # the name of a test is its sentence
from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from itertools import chain
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from explore_bt.errors import UserError
from explore_bt.interfaces import API_VERSION, RobotContext, Slam
from explore_bt.testing.cloud_contract import CloudSlamContract
from explore_bt.testing.slam_room import Room, RoomTruth, ScriptedRobot
from explore_bt.types import (
    FREE,
    OCCUPIED,
    STRETCH_KEYFRAMES,
    UNKNOWN,
    Health,
    Imu,
    Measurement,
    Pose2,
    Scan2D,
)

__all__ = ["SlamContract"]

_START = Pose2(-0.6, -0.5, 0.0)


class SlamContract(CloudSlamContract):
    """Inherit, write ``make``, and let pytest find the subclass.

    Attributes:
        tolerance_m: how far the estimate may be from the truth in the suite's room.
        takes_clouds, cloud_tolerance_m: of a 3D lidar, see ``CloudSlamContract``.
    """

    tolerance_m: ClassVar[float] = 0.05

    def make(self) -> Slam:
        """A new plugin with its default options; ``setup`` is called by the suite."""
        raise NotImplementedError("write make() so that it returns your plugin")

    def test_it_says_what_it_is(self) -> None:
        slam = self.make()
        assert slam.kind == "slam", f"kind is {slam.kind!r}: inherit from explore_bt.interfaces.Slam"
        assert slam.name, "name is empty: missions could not say {use: ...}"
        assert slam.api_version == API_VERSION, f"written for API {slam.api_version}, this is {API_VERSION}"

    def test_it_starts_where_it_is_told(self) -> None:
        slam, robot = self._ready(Pose2(-0.6, -0.5, 1.0))
        before = slam.estimate().T_map_base
        assert before.distance_to(robot.pose) < 1e-6, (
            f"before the first measurement estimate() is at {before}, context.start was {robot.pose}"
        )
        _feed(slam, robot.drive(0.0, 0.0, 0.3))
        off = slam.estimate().T_map_base.distance_to(robot.pose)
        assert off < self.tolerance_m, f"the first scans moved the start by {off:.3f} m"

    def test_the_floor_under_the_robot_is_free_from_the_start(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.0, 0.0, 0.3))
        value = slam.grid().value_at(*robot.pose.xy)
        assert value == FREE, f"the cell the robot stands on is {value}, not FREE ({FREE})"

    def test_a_robot_at_rest_stays_at_rest(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.0, 0.0, 5.0))
        off = slam.estimate().T_map_base.between(robot.pose)
        assert math.hypot(off.x, off.y) < self.tolerance_m, (
            f"standing still drifted {off.x:.3f}, {off.y:.3f} m"
        )
        assert abs(off.yaw_rad) < 0.02, f"standing still turned {math.degrees(off.yaw_rad):.1f} degrees"

    def test_the_same_scan_again_moves_nothing(self) -> None:
        slam, robot = self._ready(_START)
        measured = list(robot.drive(0.0, 0.0, 0.5))
        _feed(slam, measured)
        before = slam.estimate().T_map_base
        last = [each for each in measured if isinstance(each, Scan2D)][-1]
        slam.update(dataclasses.replace(last, stamp_s=last.stamp_s + 0.1))
        moved = slam.estimate().T_map_base.distance_to(before)
        assert moved < 0.02, f"estimate() moved {moved:.2f} m between two identical scans"

    def test_a_driven_square_is_followed(self) -> None:
        slam, robot = self._ready(_START)
        worst = 0.0
        for _ in range(4):
            _feed(slam, robot.drive(0.4, 0.0, 3.0), robot.drive(0.0, 1.0, math.pi / 2))
            worst = max(worst, slam.estimate().T_map_base.distance_to(robot.pose))
        assert worst < self.tolerance_m, f"at a corner of the square the estimate was {worst:.3f} m off"
        health = slam.estimate()
        assert health.health is Health.OK, f"after an easy drive health is {health.health}: {health.reason}"

    def test_what_it_tells_its_team_of_its_graph_is_whole(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.3, 0.2, 6.0))
        share = slam.graph_share()
        count = share.keyframe_count()
        stretches = [share.stretch(number) for number in range(math.ceil(count / STRETCH_KEYFRAMES))]
        told = sum(len(each.poses) for each in stretches)
        assert told == count, f"{count} keyframes, but stretches tell the poses of {told}"
        for number in range(count):
            points = share.keyframe(number).points
            assert points.ndim == 2, f"keyframe {number}: points have shape {points.shape}, not (N, 2)"
            assert np.isfinite(points).all(), f"keyframe {number} has points that are not finite"
        steps = {edge.b for each in stretches for edge in each.edges if not edge.is_closure}
        missing = sorted(set(range(1, count)) - steps)
        assert not missing, f"no constraint tells how keyframes {missing} were reached"
        share.look()
        assert share.fit("nobody") is None, "a mate that has told nothing has a fit"

    def test_the_estimate_is_stamped_and_its_covariance_is_one(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.3, 0.3, 1.0))
        estimate = slam.estimate()
        late = robot.time_s - estimate.stamp_s
        assert 0.0 <= late <= 0.11, f"estimate() is stamped {late:.3f} s before the newest scan"
        assert estimate.covariance.shape == (3, 3), f"covariance has shape {estimate.covariance.shape}"
        assert np.allclose(estimate.covariance, estimate.covariance.T), "covariance is not symmetric"
        assert np.linalg.eigvalsh(estimate.covariance)[0] > -1e-12, "covariance has a negative eigenvalue"
        assert estimate.map_revision == slam.grid().revision, "map_revision is not grid().revision"

    def test_the_grid_is_frozen_and_the_same_while_its_revision_stands(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.3, 0.0, 1.0))
        grid, before = slam.grid(), slam.grid().cells.copy()
        assert slam.grid() is grid, "grid() gave two objects for one revision"
        assert not grid.cells.flags.writeable, "grid().cells can be written to"
        _feed(slam, robot.drive(0.3, 0.5, 2.0))
        assert np.array_equal(grid.cells, before), "a grid handed out earlier changed afterwards"
        later = slam.grid()
        assert later.revision > grid.revision, f"two different maps share revision {grid.revision}"

    def test_what_is_forgotten_is_free_until_it_is_seen_again(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.0, 0.0, 1.0))
        before, (x, y) = slam.grid(), robot.pose.xy
        reach_m = 3.0
        if not slam.forget_near((x, y), reach_m):
            assert slam.grid() is before, "forget_near() said that it cannot, and changed the map"
            return
        after = slam.grid()
        centres = before.centers_of(np.argwhere(before.cells == OCCUPIED))
        away_m = np.hypot(centres[:, 0] - x, centres[:, 1] - y)
        now = after.cells[before.cells == OCCUPIED]
        inner, outer = away_m < reach_m - 0.1, away_m > reach_m + 0.1
        assert (now[inner] == FREE).all(), f"an obstacle within {reach_m} m is still there"
        assert (now[outer] == OCCUPIED).all(), f"an obstacle beyond {reach_m} m is gone"
        assert np.array_equal(after.cells[before.cells != OCCUPIED], before.cells[before.cells != OCCUPIED])
        _feed(slam, robot.drive(0.0, 0.0, 1.5))
        back = np.mean(slam.grid().cells[before.cells == OCCUPIED][inner] == OCCUPIED)
        assert back > 0.8, f"only {100.0 * back:.0f} % of what stands in sight came back"

    def test_changed_since_names_every_changed_cell(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.2, 0.0, 0.5))
        told = 0
        for turn_rate in (0.0, 0.8, -0.8, 0.0, 0.5, 0.0):
            before = slam.grid()
            _feed(slam, robot.drive(0.2, turn_rate, 0.5))
            after, window = slam.grid(), slam.changed_since(before.revision)
            if window is None:
                continue
            told += 1
            assert before.shape == after.shape, "the grid has grown and changed_since did not say None"
            assert before.origin_xy == after.origin_xy, (
                "the grid has moved and changed_since did not say None"
            )
            changed = before.cells != after.cells
            changed[window.slices] = False
            assert not changed.any(), f"{changed.sum()} changed cells lie outside changed_since's {window}"
        assert told, "changed_since said None every time: planners would start from nothing at each tick"
        nothing = slam.changed_since(slam.grid().revision)
        assert nothing is not None, "changed_since of the present revision is None, not an empty window"
        assert nothing.is_empty, f"changed_since of the present revision is {nothing}, not empty"

    def test_the_map_agrees_with_the_room(self) -> None:
        slam, robot = self._ready(_START)
        for _ in range(2):
            _feed(slam, robot.drive(0.4, 0.0, 3.0), robot.drive(0.0, 1.0, math.pi))
        grid = slam.grid()
        assert set(np.unique(grid.cells)) <= {FREE, OCCUPIED, UNKNOWN}, f"cells hold {np.unique(grid.cells)}"
        occupied = grid.centers_of(np.argwhere(grid.occupied))
        assert len(occupied) > 100, f"only {len(occupied)} occupied cells in a walled room"
        far = robot.room.distance(occupied) > 2.0 * grid.resolution_m
        assert far.mean() < 0.02, f"{far.mean():.1%} of the occupied cells are over two cells from any wall"
        free = grid.centers_of(np.argwhere(grid.free))
        outside = (np.abs(free) > np.array([3.0, 2.0]) + 1.5 * grid.resolution_m).any(axis=1)
        assert outside.mean() < 0.005, f"{outside.mean():.1%} of the free cells lie behind the walls"
        area = len(free) * grid.resolution_m**2
        assert area > 15.0, f"only {area:.1f} m² of 23 m² are free after looking around"

    def test_beams_without_return_clear_and_invalid_beams_do_not(self) -> None:
        for value, wanted in ((math.inf, FREE), (math.nan, UNKNOWN)):
            slam, robot = self._ready(_START)
            for measurement in robot.drive(0.0, 0.0, 0.3):
                slam.update(_forward(measurement, value))
            ahead = slam.grid().value_at(robot.pose.x + 0.8, robot.pose.y)
            assert ahead == wanted, f"0.8 m along a {value} beam the map says {ahead}, expected {wanted}"

    @pytest.mark.parametrize("fault", ["all_nan", "empty", "backwards"])
    def test_bad_scans_are_survived_and_reported(self, fault: str) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.0, 0.0, 1.0))
        before = slam.estimate().T_map_base
        seen = Health.OK
        for measurement in robot.drive(0.0, 0.0, 2.0):
            slam.update(_spoilt(measurement, fault))
            seen = slam.estimate().health if slam.estimate().health is not Health.OK else seen
        assert seen is not Health.OK, f"two seconds of scans that are {fault}, and health said ok throughout"
        assert slam.estimate().reason, "health is not ok and gives no reason"
        moved = slam.estimate().T_map_base.distance_to(before)
        assert moved < 0.2, f"scans that are {fault} moved a standing robot by {moved:.2f} m"
        _feed(slam, robot.drive(0.0, 0.0, 1.0))
        after = slam.estimate()
        assert after.health is Health.OK, (
            f"good scans came back and health stayed {after.health}: {after.reason}"
        )
        assert after.T_map_base.distance_to(robot.pose) < self.tolerance_m, (
            "it did not find back to the truth"
        )

    def test_silence_is_reported_as_lost(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.0, 0.0, 0.5))
        _feed(slam, (each for each in robot.drive(0.0, 0.0, 3.0) if isinstance(each, Imu)))
        health = slam.estimate()
        assert health.health is Health.LOST, f"no scan for 3 s and health is {health.health}, not lost"
        assert health.reason, "it is lost and gives no reason"

    def test_the_same_measurements_give_the_same_bits(self) -> None:
        first, second = (self._driven() for _ in range(2))
        assert first.estimate().T_map_base == second.estimate().T_map_base, "poses differ between two runs"
        assert np.array_equal(first.trajectory().poses, second.trajectory().poses), "trajectories differ"
        assert np.array_equal(first.grid().cells, second.grid().cells), "maps differ between two runs"

    def test_the_trajectory_has_one_pose_per_scan(self) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.3, 0.2, 2.0))
        trajectory = slam.trajectory()
        assert len(trajectory.stamps_s) == 20, f"20 scans, {len(trajectory.stamps_s)} poses"
        assert trajectory.poses.shape == (20, 3), f"poses have shape {trajectory.poses.shape}"
        assert (np.diff(trajectory.stamps_s) > 0.0).all(), "stamps do not increase"
        truth = np.array([robot.pose_at(stamp_s).as_array() for stamp_s in trajectory.stamps_s])
        off = np.hypot(*(trajectory.poses - truth)[:, :2].T)
        assert off.max() < self.tolerance_m, f"the trajectory is up to {off.max():.3f} m off"

    def test_the_figures_are_numbers(self) -> None:
        figures = self._driven().figures()
        for key in ("keyframes", "loop_closures", "ms_per_scan_median"):
            assert key in figures, f"figures() lacks {key}"
        assert all(math.isfinite(value) for value in figures.values()), f"figures() holds {dict(figures)}"

    def test_a_saved_map_is_gone_on_in(self, tmp_path: Path) -> None:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.4, 0.0, 2.0), robot.drive(0.0, 1.0, 1.0))
        slam.save(tmp_path)
        resumed = self.make()
        resumed.setup(_context(robot))
        resumed.load(tmp_path)
        before, after = slam.grid(), resumed.grid()
        assert before.shape == after.shape, f"the map was {before.shape} and came back as {after.shape}"
        assert np.array_equal(before.cells, after.cells), "the map changed by being saved and loaded"
        assert len(resumed.trajectory().stamps_s) == 30, "the trajectory so far was not kept"
        _feed(resumed, robot.drive(0.3, 0.0, 2.0))
        off = resumed.estimate().T_map_base.distance_to(robot.pose)
        assert off < self.tolerance_m, f"after load() the estimate is {off:.3f} m off"

    def test_loading_nothing_is_the_users_error(self, tmp_path: Path) -> None:
        slam, _ = self._ready(_START)
        with pytest.raises(UserError):
            slam.load(tmp_path)

    def _ready(self, start: Pose2, seed: int = 0) -> tuple[Slam, ScriptedRobot]:
        robot = ScriptedRobot(Room.furnished(), start, seed)
        slam = self.make()
        slam.setup(_context(robot))
        return slam, robot

    def _driven(self) -> Slam:
        slam, robot = self._ready(_START)
        _feed(slam, robot.drive(0.4, 0.0, 2.0), robot.drive(0.0, 1.2, 1.0), robot.drive(0.4, 0.4, 1.5))
        return slam


def _context(robot: ScriptedRobot) -> RobotContext:
    return RobotContext(start=robot.pose, footprint_radius_m=0.2, truth=RoomTruth(robot))


def _feed(slam: Slam, *drives: Iterable[Measurement]) -> None:
    for measurement in chain.from_iterable(drives):
        slam.update(measurement)


def _forward(measurement: Measurement, value: float) -> Measurement:
    """The scan with all beams within 60° of straight ahead replaced."""
    if not isinstance(measurement, Scan2D):
        return measurement
    ahead = np.abs(measurement.angles_rad) < math.pi / 3.0
    ranges = np.where(ahead, np.float32(value), measurement.ranges_m).astype(np.float32)
    return dataclasses.replace(measurement, ranges_m=ranges)


def _spoilt(measurement: Measurement, fault: str) -> Measurement:
    if not isinstance(measurement, Scan2D):
        return measurement
    if fault == "all_nan":
        return dataclasses.replace(measurement, ranges_m=np.full_like(measurement.ranges_m, np.nan))
    if fault == "backwards":
        return dataclasses.replace(measurement, stamp_s=measurement.stamp_s - 10.0)
    none = np.zeros(0)
    return dataclasses.replace(measurement, angles_rad=none, ranges_m=none.astype(np.float32), times_s=none)

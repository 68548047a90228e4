"""What every planner must do, as tests to inherit.

::

    class TestMyPlanner(PlannerContract):
        def make(self):
            return MyPlanner(MyPlanner.Options())
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
import pytest
from numpy.typing import NDArray

from explore_bt.errors import Cancelled, GoalBlocked, GoalUnknown, NoPath, StartBlocked
from explore_bt.interfaces import API_VERSION, Planner, RobotContext
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Path, Pose2, way_along, wrap_angle

__all__ = ["PlannerContract", "exact_clearance", "points_along"]

RADIUS_M = 0.25
RESOLUTION_M = 0.05
_ROUNDING_M = 0.005


def exact_clearance(grid: OccupancyGrid, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) metres from (N, 2) points to the nearest cell centre that is not free, less half a cell.

    Independent of any distance transform; the cells around the grid count as unknown.
    """
    free = np.pad(grid.cells == FREE, 1)
    walled = np.argwhere(~free) - 1
    near_free = np.zeros_like(free)
    near_free[1:] |= free[:-1]
    near_free[:-1] |= free[1:]
    near_free[:, 1:] |= free[:, :-1]
    near_free[:, :-1] |= free[:, 1:]
    walled = walled[near_free[walled[:, 0] + 1, walled[:, 1] + 1]]
    centers = grid.centers_of(walled)
    distance = np.array([np.hypot(*(centers - point).T).min() for point in points])
    inside = np.array([grid.value_at(float(x), float(y)) == FREE for x, y in points])
    return np.where(inside, np.maximum(distance - 0.5 * grid.resolution_m, 0.0), 0.0)


def points_along(path: Path, step_m: float = 0.0125) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(M, 2) points along a path, poses and what lies between, and (M,) the index of the pose before each."""
    xy = path.poses[:, :2]
    points, index = [xy[:1]], [np.zeros(1, dtype=np.int64)]
    for i in range(len(xy) - 1):
        count = max(1, math.ceil(float(np.hypot(*(xy[i + 1] - xy[i]))) / step_m))
        share = np.arange(1, count + 1)[:, None] / count
        points.append(xy[i] + share * (xy[i + 1] - xy[i]))
        index.append(np.full(count, i, dtype=np.int64))
    return np.concatenate(points), np.concatenate(index)


class _Floor:
    """A small map to draw on, metres; the frame starts at (0, 0) with a wall all around."""

    def __init__(self, width_m: float, height_m: float, origin_xy: tuple[float, float] = (0.0, 0.0)) -> None:
        self.origin_xy = origin_xy
        self.cells = np.full((self._n(height_m), self._n(width_m)), FREE, dtype=np.int8)
        self.cells[[0, -1], :] = OCCUPIED
        self.cells[:, [0, -1]] = OCCUPIED

    @staticmethod
    def _n(length_m: float) -> int:
        return round(length_m / RESOLUTION_M)

    def fill(self, x0: float, y0: float, x1: float, y1: float, value: int = OCCUPIED) -> _Floor:
        """Give all cells of a rectangle one value."""
        self.cells[self._n(y0) : self._n(y1), self._n(x0) : self._n(x1)] = value
        return self

    def grid(self) -> OccupancyGrid:
        """The map as planners get it."""
        return OccupancyGrid(self.cells.copy(), RESOLUTION_M, self.origin_xy, revision=1)


def _two_rooms(barrier: int = OCCUPIED, door: bool = True) -> OccupancyGrid:
    floor = _Floor(8.0, 5.0).fill(3.9, 0.0, 4.1, 5.0, barrier)
    if door:
        floor.fill(3.9, 3.0, 4.1, 3.9, FREE)
    return floor.fill(5.5, 1.0, 6.0, 1.5).fill(1.8, 2.6, 2.2, 3.4).grid()


_LEFT, _RIGHT = Pose2(1.0, 1.0, 0.0), Pose2(7.0, 1.0, math.pi / 2)


class PlannerContract(ABC):
    """Inherit, name it ``Test...`` and give ``make``; every test plans for a footprint of 0.25 m."""

    @abstractmethod
    def make(self) -> Planner:
        """A planner as a mission would construct it."""

    @pytest.fixture
    def planner(self) -> Planner:
        """The planner under test, set up."""
        planner = self.make()
        planner.setup(RobotContext(footprint_radius_m=RADIUS_M))
        return planner

    def test_construction_is_cheap_and_names_the_plugin(self) -> None:
        """Missions are checked and drawn without a robot."""
        planner = self.make()
        assert planner.kind == "planner", f"kind is {planner.kind!r}; subclass explore_bt.interfaces.Planner"
        assert planner.name.isidentifier(), f"name {planner.name!r} is what missions write after 'use:'"
        assert planner.api_version == API_VERSION, (
            f"written for API version {planner.api_version}, this is {API_VERSION}"
        )
        assert isinstance(planner.options, type(planner).Options), "options are not of the class's Options"

    def test_a_path_through_a_door_keeps_the_footprint_clear(self, planner: Planner) -> None:
        """Poses and everything between them."""
        grid = _two_rooms()
        _require_clear(grid, planner.plan(grid, _LEFT, _RIGHT, RADIUS_M))

    def test_a_path_among_clutter_keeps_the_footprint_clear(self, planner: Planner) -> None:
        """Twenty pairs of places between boxes of random sizes."""
        rng = np.random.default_rng(7)
        floor = _Floor(8.0, 8.0)
        for x, y in rng.uniform(1.0, 7.0, size=(14, 2)):
            floor.fill(x, y, x + rng.uniform(0.1, 0.6), y + rng.uniform(0.1, 0.6))
        grid = floor.grid()
        places = rng.uniform(0.5, 7.5, size=(400, 2))
        roomy = places[exact_clearance(grid, places) > RADIUS_M + 0.15]
        for a, b in zip(roomy[:20], roomy[20:40], strict=True):
            try:
                start, goal = (Pose2(float(x), float(y), 0.0) for x, y in (a, b))
                path = planner.plan(grid, start, goal, RADIUS_M)
            except NoPath:
                continue
            _require_clear(grid, path)

    def test_a_path_starts_at_the_start_and_ends_at_the_goal(self, planner: Planner) -> None:
        """Position within a cell, heading exactly."""
        path = planner.plan(_two_rooms(), _LEFT, _RIGHT, RADIUS_M)
        for pose, wanted, name in ((path.poses[0], _LEFT, "starts"), (path.poses[-1], _RIGHT, "ends")):
            away = math.hypot(pose[0] - wanted.x, pose[1] - wanted.y)
            assert away <= RESOLUTION_M, f"plan() {name} {away:.2f} m from where it was asked to"
        off = abs(wrap_angle(float(path.poses[-1, 2]) - _RIGHT.yaw_rad))
        assert off < 1e-6, f"the last pose must have the goal's heading; it is {math.degrees(off):.1f}° off"

    def test_poses_are_dense_and_look_along_the_path(self, planner: Planner) -> None:
        """At most 0.25 m apart; yaw within 35° of the way to the next pose."""
        poses = planner.plan(_two_rooms(), _LEFT, _RIGHT, RADIUS_M).poses
        steps = np.diff(poses[:, :2], axis=0)
        gaps = np.hypot(steps[:, 0], steps[:, 1])
        assert gaps.max() <= 0.25, f"poses {gaps.argmax()} and the next are {gaps.max():.2f} m apart"
        turns = np.angle(np.exp(1j * (np.arctan2(steps[:, 1], steps[:, 0]) - poses[:-1, 2])))
        worst = int(np.abs(turns).argmax())
        assert abs(turns[worst]) < math.radians(35), (
            f"pose {worst} looks {math.degrees(turns[worst]):.0f}° away from where the path goes on"
        )

    def test_reported_clearance_is_not_flattering(self, planner: Planner) -> None:
        """Finite, one value a pose, at most half a cell above the exact one."""
        grid = _two_rooms()
        path = planner.plan(grid, _LEFT, _RIGHT, RADIUS_M)
        assert path.clearance_m.shape == (len(path.poses),), "clearance_m needs one value a pose"
        over = path.clearance_m - exact_clearance(grid, path.poses[:, :2])
        worst = int(over.argmax())
        assert np.isfinite(path.poses).all(), "poses must be finite"
        assert over[worst] <= 0.5 * RESOLUTION_M + _ROUNDING_M, (
            f"pose {worst} reports {path.clearance_m[worst]:.2f} m of clearance, "
            f"{over[worst]:.2f} m more than there is"
        )

    def test_a_map_that_does_not_begin_at_the_origin_is_planned_on_alike(self, planner: Planner) -> None:
        """Cells to metres uses the grid's origin, x for columns and y for rows."""
        grid, shift = _two_rooms(), (-3.0, 5.0)
        moved = OccupancyGrid(grid.cells.copy(), RESOLUTION_M, shift)
        here = planner.plan(grid, _LEFT, _RIGHT, RADIUS_M).poses
        there = planner.plan(moved, _moved(_LEFT, shift), _moved(_RIGHT, shift), RADIUS_M).poses
        assert len(here) == len(there), "the same map elsewhere gave another path"
        assert np.allclose(here[:, :2] + shift, there[:, :2], atol=1e-6), "the grid's origin is not respected"

    def test_a_goal_where_the_robot_stands_is_a_turn(self, planner: Planner) -> None:
        """The path stays on the spot and ends with the goal's heading."""
        path = planner.plan(_two_rooms(), _LEFT, Pose2(_LEFT.x, _LEFT.y, 2.0), RADIUS_M)
        assert path.length_m < 0.1, f"turning on the spot took {path.length_m:.2f} m"
        assert abs(wrap_angle(float(path.poses[-1, 2]) - 2.0)) < 1e-6, "it must end with the goal's heading"

    def test_unknown_space_is_an_obstacle(self, planner: Planner) -> None:
        """A strip nobody has seen divides the floor like a wall."""
        with pytest.raises(NoPath):
            planner.plan(_two_rooms(UNKNOWN, door=False), _LEFT, _RIGHT, RADIUS_M)
        grid = _two_rooms(UNKNOWN)
        _require_clear(grid, planner.plan(grid, _LEFT, _RIGHT, RADIUS_M))

    def test_no_passage_is_no_path(self, planner: Planner) -> None:
        """A closed wall, and a gap that is too narrow."""
        with pytest.raises(NoPath):
            planner.plan(_two_rooms(door=False), _LEFT, _RIGHT, RADIUS_M)
        slit = _Floor(8.0, 5.0).fill(3.9, 0.0, 4.1, 5.0).fill(3.9, 2.0, 4.1, 2.4, FREE).grid()
        with pytest.raises(NoPath):
            planner.plan(slit, _LEFT, _RIGHT, RADIUS_M)

    @pytest.mark.parametrize("goal", [Pose2(4.0, 1.0, 0.0), Pose2(5.7, 1.2, 0.0), Pose2(4.0, 0.25, 0.0)])
    def test_a_goal_in_an_obstacle_is_goal_blocked(self, planner: Planner, goal: Pose2) -> None:
        """Inside a wall or a box."""
        with pytest.raises(GoalBlocked):
            planner.plan(_two_rooms(), _LEFT, goal, RADIUS_M)

    def test_a_goal_where_the_footprint_does_not_fit_is_goal_blocked(self, planner: Planner) -> None:
        """Deep in a slot 0.3 m wide."""
        with pytest.raises(GoalBlocked):
            planner.plan(_with_slot(), _LEFT, Pose2(5.0, 4.25, 0.0), RADIUS_M)

    @pytest.mark.parametrize("goal", [Pose2(4.0, 1.0, 0.0), Pose2(20.0, 1.0, 0.0), Pose2(-1.0, 1.0, 0.0)])
    def test_a_goal_nobody_has_seen_is_goal_unknown(self, planner: Planner, goal: Pose2) -> None:
        """In unknown space, and outside of the map."""
        with pytest.raises(GoalUnknown):
            planner.plan(_two_rooms(UNKNOWN), _LEFT, goal, RADIUS_M)

    def test_a_start_with_no_way_out_is_start_blocked(self, planner: Planner) -> None:
        """Deep in a slot 0.3 m wide, and inside a wall."""
        for start in (Pose2(5.0, 4.25, 0.0), Pose2(0.0, 1.0, 0.0)):
            with pytest.raises(StartBlocked):
                planner.plan(_with_slot(), start, _LEFT, RADIUS_M)

    def test_a_start_too_near_a_wall_is_left_by_gaining_clearance(self, planner: Planner) -> None:
        """Never tighter than at the start, and clear from 0.6 m on."""
        grid = _two_rooms()
        start = Pose2(1.0, 0.05 + 0.18, 0.0)
        path = planner.plan(grid, start, _RIGHT, RADIUS_M)
        points, index = points_along(path)
        clearance = exact_clearance(grid, points)
        along = way_along(points)
        tightest = int(clearance.argmin())
        assert clearance[tightest] >= clearance[0] - 0.01, (
            f"at pose {index[tightest]} the way out is tighter ({clearance[tightest]:.2f} m) than the start"
        )
        late = (along > 0.6) & (clearance < RADIUS_M - _ROUNDING_M)
        assert not late.any(), f"{along[late][-1]:.2f} m on, the path is still too tight for the footprint"

    def test_a_cancelled_plan_is_given_up(self, planner: Planner) -> None:
        """The caller's ``cancelled`` is asked and honoured."""
        asked: list[int] = []

        def cancelled() -> bool:
            asked.append(1)
            return True

        with pytest.raises(Cancelled):
            planner.plan(_two_rooms(), _LEFT, _RIGHT, RADIUS_M, cancelled)
        assert asked, "plan() never asked cancelled()"

    def test_a_plan_does_not_depend_on_the_plans_before(self, planner: Planner) -> None:
        """Nor on failures, nor on which instance made it."""
        grid = _two_rooms()
        first = planner.plan(grid, _LEFT, _RIGHT, RADIUS_M)
        planner.plan(_with_slot(), _LEFT, _RIGHT, 0.2)
        with pytest.raises(NoPath):
            planner.plan(_two_rooms(door=False), _LEFT, _RIGHT, RADIUS_M)
        for again in (planner, self.make()):
            path = again.plan(grid, _LEFT, _RIGHT, RADIUS_M)
            assert np.array_equal(path.poses, first.poses), "the same question got another answer"

    def test_distances_are_about_as_long_as_the_paths(self, planner: Planner) -> None:
        """One pass for many goals; inf for those in a wall, in the unknown, behind a closed wall."""
        grid = _two_rooms()
        goals = [_RIGHT, Pose2(1.0, 4.0, 0.0), Pose2(3.0, 3.4, 0.0), Pose2(6.5, 4.2, 0.0), _LEFT]
        nowhere = [Pose2(4.0, 1.0, 0.0), Pose2(20.0, 1.0, 0.0)]
        found = planner.distances(grid, _LEFT, [*goals, *nowhere], RADIUS_M)
        driven = np.array([planner.plan(grid, _LEFT, goal, RADIUS_M).length_m for goal in goals])
        assert found.shape == (7,), "distances() needs one value a goal"
        assert np.isinf(found[5:]).all(), "a goal in a wall or outside of the map cannot be reached"
        assert (np.abs(found[:5] - driven) <= 0.35 * driven + 0.1).all(), (
            f"distances() said {found[:5].round(2)} m, the paths have {driven.round(2)} m"
        )
        closed = planner.distances(_two_rooms(door=False), _LEFT, goals, RADIUS_M)
        assert np.isinf(closed[[0, 3]]).all(), "there is no way through a closed wall"

    def test_a_changed_map_is_seen(self, planner: Planner) -> None:
        """A new grid with the same revision from another source is another map."""
        planner.plan(_two_rooms(), _LEFT, _RIGHT, RADIUS_M)
        with pytest.raises(NoPath):
            planner.plan(_two_rooms(door=False), _LEFT, _RIGHT, RADIUS_M)

    def test_the_map_is_left_alone(self, planner: Planner) -> None:
        """Not a cell is written."""
        grid = _two_rooms()
        before = grid.cells.copy()
        planner.plan(grid, _LEFT, _RIGHT, RADIUS_M)
        assert np.array_equal(grid.cells, before), "plan() wrote into the map"
        assert not grid.cells.flags.writeable, "plan() made the map writeable"


def _with_slot() -> OccupancyGrid:
    """One room, with a slot 0.3 m wide and 1.5 m deep from above, at x = 5, open below."""
    return _Floor(8.0, 5.0).fill(4.2, 3.0, 4.85, 5.0).fill(5.15, 3.0, 5.8, 5.0).grid()


def _moved(pose: Pose2, shift: tuple[float, float]) -> Pose2:
    return Pose2(pose.x + shift[0], pose.y + shift[1], pose.yaw_rad)


def _require_clear(grid: OccupancyGrid, path: Path) -> None:
    points, index = points_along(path)
    clearance = exact_clearance(grid, points)
    worst = int(clearance.argmin())
    assert clearance[worst] >= RADIUS_M - _ROUNDING_M, (
        f"plan() passed {clearance[worst]:.2f} m from an obstacle or unknown cell; "
        f"the footprint needs {RADIUS_M:.2f} m, after pose {index[worst]}"
    )

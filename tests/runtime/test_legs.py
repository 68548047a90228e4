import math

import numpy as np
import pytest

from explore_bt.errors import Cancelled, GoalBlocked, NoPath, PlanningFailure
from explore_bt.runtime.legs import plan_through
from explore_bt.types import Path, Pose2

HERE, GOAL = Pose2(0.0, 0.0, 0.0), Pose2(6.0, 0.0, 1.0)


class Straight:
    """Plans straight lines, and refuses what it is told to refuse."""

    def __init__(self, refusals: dict[tuple[float, float], type[PlanningFailure]] | None = None) -> None:
        self.refusals = refusals or {}
        self.legs: list[tuple[tuple[float, float], tuple[float, float]]] = []

    def __call__(self, start: Pose2, goal: Pose2) -> Path:
        self.legs.append((start.xy, goal.xy))
        if goal.xy in self.refusals:
            raise self.refusals[goal.xy]("refused")
        count = max(2, math.ceil(start.distance_to(goal) / 0.1))
        xys = np.linspace(start.xy, goal.xy, count)
        return Path(np.column_stack((xys, np.full(count, goal.yaw_rad))), np.linspace(1.0, 2.0, count))


def test_without_places_on_the_way_it_is_the_plan_itself() -> None:
    plan = Straight()
    path = plan_through(plan, HERE, (), GOAL)
    assert plan.legs == [(HERE.xy, GOAL.xy)]
    assert path.goal == GOAL


def test_the_path_goes_over_all_places_without_a_jump() -> None:
    via = ((1.0, 1.0), (3.0, -1.0), (5.0, 1.0))
    path = plan_through(Straight(), HERE, via, GOAL)
    assert path.goal == GOAL
    assert path.poses[0, :2].tolist() == [0.0, 0.0]
    at = [int(np.argmin(np.hypot(*(path.poses[:, :2] - place).T))) for place in via]
    assert at == sorted(at)
    assert max(np.hypot(*(path.poses[:, :2] - place).T).min() for place in via) < 1e-9
    steps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    assert 0.0 < steps.min() <= steps.max() < 0.15
    assert len(path.poses) == len(path.clearance_m)


def test_places_that_no_way_leads_to_and_those_already_there_are_left_out() -> None:
    plan = Straight({(2.0, 0.0): GoalBlocked})
    path = plan_through(plan, HERE, ((0.05, 0.0), (2.0, 0.0), (4.0, 1.0), (6.0, 0.05)), GOAL)
    assert plan.legs == [((0.0, 0.0), (2.0, 0.0)), ((0.0, 0.0), (4.0, 1.0)), ((4.0, 1.0), (6.0, 0.0))]
    assert path.goal == GOAL


def test_only_the_way_to_the_goal_decides() -> None:
    with pytest.raises(NoPath):
        plan_through(Straight({GOAL.xy: NoPath}), HERE, ((2.0, 1.0),), GOAL)


def test_a_planner_that_was_cancelled_is_not_asked_again() -> None:
    plan = Straight({(2.0, 1.0): Cancelled})
    with pytest.raises(Cancelled):
        plan_through(plan, HERE, ((2.0, 1.0), (3.0, 1.0)), GOAL)
    assert len(plan.legs) == 1

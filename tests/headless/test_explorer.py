from __future__ import annotations

import numpy as np
import pytest

from explore_bt import Explorer
from explore_bt.errors import UserError
from explore_bt.exploration import clearance_at
from explore_bt.headless import STRATEGIES
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid, Pose2
from tests.headless.drive import explore, share_seen

START = Pose2(1.5, 1.5, 0.0)


def flat(resolution_m: float = 0.1) -> OccupancyGrid:
    """8 × 6 m: four rooms round a cross of walls with doors, and a cupboard in one."""
    metres = np.full((60, 80), FREE, dtype=np.int8)
    metres[[0, -1], :] = metres[:, [0, -1]] = OCCUPIED
    metres[30, :] = metres[:, 40] = OCCUPIED
    metres[30, 12:22] = metres[30, 55:65] = metres[10:20, 40] = FREE
    metres[40:52, 20:26] = OCCUPIED
    fine = round(0.1 / resolution_m)
    return OccupancyGrid(np.kron(metres, np.ones((fine, fine), dtype=np.int8)), resolution_m, (0.0, 0.0))


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_strategy_ends_and_proposes_no_goal_whose_footprint_is_not_free(strategy: str) -> None:
    truth = flat()
    explorer = Explorer(strategy, robot_radius_m=0.2)
    decision = None
    for grid, pose, decision in explore(explorer, truth, START):
        if decision.path is not None and decision.goal is not None:
            ahead = np.array([decision.goal.xy])
            assert clearance_at(grid, ahead, 0.3)[0] >= 0.2 - 1e-3 or len(decision.path.poses) == 1
            assert np.hypot(*(decision.path.poses[0, :2] - pose.xy)) < 2.0
    assert decision is not None
    assert decision.done
    assert decision.reason
    if strategy != "paper":
        assert share_seen(truth, grid) > 0.99


def test_an_unknown_strategy_is_refused_with_a_list_of_those_there_are() -> None:
    with pytest.raises(UserError, match="there is no nearst; expected one of complete, paper"):
        Explorer("nearst")


def test_once_over_it_stays_over() -> None:
    explorer = Explorer(robot_radius_m=0.2)
    *_, (grid, pose, decision) = explore(explorer, flat(), START)
    assert decision.done
    assert explorer.decide(grid, pose) is decision


def test_several_robots_have_a_decision_each() -> None:
    truth = flat()
    explorer = Explorer(robot_radius_m=0.2)
    decisions = explorer.decide(truth, {"one": START, "two": Pose2(6.0, 4.5, 0.0)})
    assert set(decisions) == {"one", "two"}
    assert all(decision.done for decision in decisions.values())

from __future__ import annotations

import itertools

import numpy as np
import pytest

from explore_bt import Explorer
from explore_bt.errors import UserError
from explore_bt.exploration import clearance_at
from explore_bt.headless import STRATEGIES
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2
from tests.headless.drive import advanced, explore, look, share_seen

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


def test_more_safety_weight_gives_a_roomier_way() -> None:
    cells = np.full((80, 80), FREE, dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    cells[20:60, 20:60] = OCCUPIED
    cells[50:, 64:] = UNKNOWN
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    least_m = []
    for weight in (0.0, 12.0):
        path = Explorer(robot_radius_m=0.2, safety_weight=weight).decide(grid, Pose2(3.5, 0.5, 0.0)).path
        assert path is not None
        least_m.append(float(np.mean(path.clearance_m)))
    assert least_m[1] > 1.2 * least_m[0]


def test_a_safety_weight_below_zero_is_refused() -> None:
    with pytest.raises(UserError, match="safety_weight: -1 found, expected a finite number of at least 0"):
        Explorer(safety_weight=-1)


def test_once_over_it_stays_over() -> None:
    explorer = Explorer(robot_radius_m=0.2)
    *_, (grid, pose, decision) = explore(explorer, flat(), START)
    assert decision.done
    assert explorer.decide(grid, pose) is decision


def test_several_robots_have_a_decision_each() -> None:
    truth = flat()
    explorer = Explorer(robot_radius_m=0.2)
    poses = {"one": START, "two": Pose2(6.0, 4.5, 0.0)}
    decisions = explorer.decide(truth, poses)
    assert set(decisions) == {"one", "two"}
    assert decisions["two"].done, "one had found nothing before"
    decisions = explorer.decide(truth, poses)
    assert all(decision.done for decision in decisions.values())


def team_path_m(names: list[str]) -> tuple[float, float, list[float]]:
    """All start in one place; the longest way, the share seen, how far apart two goals were."""
    truth, explorer = flat(), Explorer(robot_radius_m=0.2)
    known = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    poses, driven_m, apart_m = dict.fromkeys(names, START), dict.fromkeys(names, 0.0), []
    for revision in range(400):
        for pose in poses.values():
            look(truth, known, pose)
        grid = OccupancyGrid(known.copy(), truth.resolution_m, truth.origin_xy, revision)
        decisions = explorer.decide(grid, poses)
        going = {name: each for name, each in decisions.items() if each.path is not None}
        goals = [each.goal for each in going.values() if each.goal is not None]
        apart_m += [a.distance_to(b) for a, b in itertools.combinations(goals, 2)]
        if not going:
            return max(driven_m.values()), share_seen(truth, grid), apart_m
        for name, decision in going.items():
            there = advanced(decision, poses[name])
            driven_m[name] += there.distance_to(poses[name])
            poses[name] = there
    raise AssertionError("they do not end")


def test_two_robots_divide_the_work() -> None:
    alone_m, share_alone, _ = team_path_m(["one"])
    both_m, share_both, apart_m = team_path_m(["one", "two"])
    assert min(share_alone, share_both) > 0.99
    assert both_m < 0.75 * alone_m
    assert np.median(apart_m) > 2.0


def two_rooms(gap_cells: int) -> OccupancyGrid:
    """7 × 4 m at 5 cm: two rooms with a gap between them."""
    cells = np.full((80, 140), FREE, dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = cells[:, 70] = OCCUPIED
    cells[40 : 40 + gap_cells, 70] = FREE
    return OccupancyGrid(cells, 0.05, (0.0, 0.0))


@pytest.mark.parametrize("strategy", ["complete", "nearest_frontier", "tour", "information_gain"])
def test_a_room_behind_a_gap_too_narrow_is_named_at_the_end(strategy: str) -> None:
    *_, (grid, _, decision) = explore(Explorer(strategy, robot_radius_m=0.2), two_rooms(7), START)
    assert decision.done
    assert grid.unknown[:, 80:].any()
    missing = "too narrow by 3 cm" if strategy == "complete" else "too narrow by"
    assert any(missing in sentence for sentence in decision.remaining)


def test_a_gap_of_two_radii_and_ten_centimetres_is_passed() -> None:
    *_, (grid, _, decision) = explore(Explorer(robot_radius_m=0.2), two_rooms(10), START)
    assert decision.done
    assert share_seen(two_rooms(10), grid) > 0.99


@pytest.mark.parametrize("strategy", ["complete", "information_gain"])
def test_decisions_are_the_same_on_cells_of_five_and_of_ten_centimetres(strategy: str) -> None:
    explorers = [Explorer(strategy, robot_radius_m=0.2) for _ in range(2)]
    apart = []
    for grid, pose, coarse in explore(explorers[0], flat(), START):
        cells = np.kron(grid.cells, np.ones((2, 2), dtype=np.int8))
        fine = explorers[1].decide(OccupancyGrid(cells, 0.05, grid.origin_xy), pose)
        assert coarse.done == fine.done
        if coarse.goal is not None and fine.goal is not None:
            apart.append(coarse.goal.distance_to(fine.goal))
    assert max(apart) < 0.05


def test_cells_of_five_and_of_ten_centimetres_are_explored_to_the_end_and_about_as_fast() -> None:
    lengths_m = []
    for resolution_m in (0.1, 0.05):
        truth = flat(resolution_m)
        *way, (grid, last, decision) = explore(Explorer(robot_radius_m=0.2), truth, START)
        assert decision.done
        assert share_seen(truth, grid) > 0.99
        poses = [pose for _, pose, _ in way] + [last]
        lengths_m.append(sum(a.distance_to(b) for a, b in itertools.pairwise(poses)))
    assert max(lengths_m) < 1.25 * min(lengths_m)


def test_a_robot_that_gets_no_farther_is_sent_another_way_and_ends() -> None:
    explorer, truth = Explorer(robot_radius_m=0.2), flat()
    cells = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    look(truth, cells, START)
    grid = OccupancyGrid(cells, truth.resolution_m, truth.origin_xy)
    goals = set()
    for _ in range(2000):
        decision = explorer.decide(grid, START)
        if decision.done:
            break
        assert decision.goal is not None
        goals.add(decision.goal.xy)
    assert decision.done
    assert len(goals) > 1

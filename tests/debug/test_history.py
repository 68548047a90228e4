"""What can be looked back at: all of it, as it was, and never more than there is room for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from explore_bt.debug import History
from explore_bt.debug import history as history_module
from explore_bt.interfaces import Event, NodeState, RobotSnapshot, TickSnapshot
from explore_bt.testing.fake_robot import full_circle_scan, open_floor
from explore_bt.types import Estimate, MotionState, OccupancyGrid, Pose2, Score

GRID = open_floor(2.0)


def tick(index: int, grid: OccupancyGrid = GRID, status: str = "running", goal: object = "a") -> TickSnapshot:
    robot = RobotSnapshot(
        robot="robot",
        estimate=Estimate(index / 10, Pose2(index / 10, 0.0, 0.0)),
        grid=grid,
        scan=full_circle_scan(),
        path=None,
        motion=MotionState(),
        gate_reason="",
        nodes=(NodeState(status, ""), NodeState("idle", f"tick {index // 5}")),
        blackboard={"goal": goal},
        score=Score(),
    )
    return TickSnapshot(index, index / 10, (robot,))


def kept(*ticks: TickSnapshot) -> History:
    history = History()
    for each in ticks:
        history.on_tick(each)
    return history


def test_every_tick_is_found_by_its_index_and_by_its_time():
    history = kept(*map(tick, range(3, 50)))
    for index in range(3, 50):
        assert history.at(index).index == index
        assert history.at_time(index / 10).index == index
    assert (history.at(0).index, history.at(99).index) == (3, 49)
    assert (history.at_time(0.0).index, history.at_time(99.0).index) == (3, 49)
    assert kept().at(0) is None
    assert kept().at_time(0.0) is None


def test_what_is_kept_is_what_was_shown():
    statuses = ("success", "running", "running")
    shown = [tick(index, status=statuses[index % 3], goal=index // 4) for index in range(20)]
    history = kept(*shown)
    for each in shown:
        (was,), (now,) = each.robots, history.at(each.index).robots
        assert (now.nodes, now.blackboard, now.estimate) == (was.nodes, was.blackboard, was.estimate)
        assert now.grid is was.grid


def test_what_stays_as_it_is_is_kept_once():
    goal = "a goal"
    history = kept(*(tick(index, goal=goal) for index in range(5)))
    first, last = history.at(0).robots[0], history.at(4).robots[0]
    assert last.nodes is first.nodes
    assert last.blackboard is first.blackboard
    assert (last.scan, last.measured) == (None, ())


def test_the_oldest_ticks_go_when_there_are_too_many(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(history_module, "MOST_TICKS", 10)
    history = kept(*map(tick, range(25)))
    assert (history.at(0).index, history.at(99).index) == (15, 24)


def test_the_oldest_ticks_go_when_their_maps_take_too_much(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(history_module, "MOST_MAP_BYTES", 3 * GRID.cells.nbytes)
    grids = [replace(GRID, cells=np.array(GRID.cells)) for _ in range(6)]
    history = kept(*(tick(index, grids[index // 4]) for index in range(24)))
    assert history.at(0).index == 12  # the last three maps
    assert history.at(0).robots[0].grid is grids[3]


def test_one_map_that_is_too_large_by_itself_is_kept_all_the_same(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(history_module, "MOST_MAP_BYTES", 1)
    history = kept(tick(0), tick(1, replace(GRID, cells=np.array(GRID.cells))))
    assert history.at(99).index == 1


def test_a_trail_is_where_the_robot_was_up_to_a_tick():
    history = kept(*map(tick, range(10)))
    assert history.trail("robot", 3) == [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0), (0.3, 0.0)]
    assert history.trail("nobody", 3) == []


def test_the_newest_events_are_kept():
    history = History()
    for number in range(history_module.MOST_EVENTS + 5):
        history.on_event(Event(number, "robot", "info", "test", str(number)))
    assert [event.message for event in history.events(2)] == ["503", "504"]
    assert len(history.events(10**6)) == history_module.MOST_EVENTS

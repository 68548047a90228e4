import math
from dataclasses import dataclass
from pathlib import Path as File

import numpy as np
import pytest
from exploration_stage import CanvasDrawer, set_stage

from explore_bt.evaluation import PlainNearestFrontier, TrialSettings, run_trial
from explore_bt.types import Path, Pose2

ROOM = File(__file__).parents[2] / "missions" / "worlds" / "room.yaml"
SETTINGS = TrialSettings(most_path_m=300.0)


@dataclass
class Said:
    goal: Pose2 | None = None
    path: Path | None = None
    done: bool = False
    outcome: str = ""
    reason: str = ""


class Scripted:
    """Gives one path after another, each from where the robot stands, and then is done."""

    def __init__(self, *ways):
        self.ways = list(ways)
        self.poses = []

    def decide(self, grid, pose):
        self.poses.append(pose)
        if not self.ways:
            return Said(done=True, outcome="explored")
        vertices = [pose.xy, *self.ways.pop(0)]
        path = Path(np.array([(*xy, 0.0) for xy in vertices]), np.ones(len(vertices)))
        return Said(goal=path.goal, path=path)


@pytest.fixture(scope="module")
def stage():
    return set_stage(ROOM, 0.2, 5.0, 1, 0, [Pose2(1.0, 1.0, 0.0)])


def trial_of(stage, decider, settings=SETTINGS):
    return run_trial(decider, stage.world, CanvasDrawer(0.2, 5.0), stage.floor, stage.starts[0], settings)


def test_a_straight_drive_is_measured_exactly(stage):
    trial = trial_of(stage, Scripted([(1.4, 1.0)], [(1.4, 1.3)]))
    assert trial.path_m == pytest.approx(0.7)
    assert trial.turning_rad == pytest.approx(math.pi)  # to the left, and at each path's end to face along x
    assert trial.time_s == pytest.approx(
        0.4 / 0.5 + max(0.2 / 0.5 + 0.1 / 0.5 + math.pi / 2 - 0.2, 0) + math.pi / 2
    )
    assert (trial.outcome, trial.contacts, trial.goal_changes, trial.goals_dropped) == ("explored", 0, 1, 0)


def test_a_long_path_is_driven_half_a_metre_at_a_time(stage):
    decider = Scripted(*[[(1.0, 2.5)]] * 2)
    trial = trial_of(stage, decider)
    assert [pose.y for pose in decider.poses] == pytest.approx([1.0, 1.5, 1.0 + 1.0])
    assert (trial.goal_changes, trial.path_m) == (0, pytest.approx(1.0))


def test_a_path_into_a_wall_counts_contacts_and_never_passes_it(stage):
    trial = trial_of(stage, Scripted(*[[(-3.0, 1.0)]] * 12))
    assert trial.contacts >= 1
    assert trial.min_clearance_m >= 0.2 - 1e-6
    assert trial.track[:, 0].min() >= 0.25 - 1e-6


def test_who_moves_nothing_is_stuck_and_who_never_ends_is_stopped(stage):
    still = [[]] * 100
    assert trial_of(stage, Scripted(*still)).outcome == "stuck"
    there_and_back = [[(1.4, 1.0)], [(1.0, 1.0)]] * 100
    trial = trial_of(stage, Scripted(*there_and_back), TrialSettings(most_path_m=10.0))
    assert trial.outcome == "over_budget"
    assert trial.path_m == pytest.approx(10.0, abs=0.5)


def test_a_goal_left_before_it_is_reached_counts_as_dropped(stage):
    trial = trial_of(stage, Scripted([(1.0, 2.4)], [(2.0, 2.0)]))
    assert (trial.goal_changes, trial.goals_dropped) == (1, 1)


def test_the_plain_nearest_frontier_explores_a_room_without_touching_it(stage):
    trial = trial_of(stage, PlainNearestFrontier())
    assert trial.outcome == "explored"
    assert trial.coverage > 0.99
    assert trial.contacts == 0
    assert trial.path_to_m(0.9) <= trial.path_to_m(0.95) <= trial.path_m
    assert math.isinf(trial.path_to_m(1.01))
    assert trial.coverage_at_s(trial.time_to_s(0.95)) >= 0.95
    assert trial.coverage_at_s(0.0) == trial.curve[0, 2]
    assert (np.diff(trial.curve[:, :2], axis=0) >= 0.0).all()


def test_the_same_trial_twice_is_the_same(stage):
    one, other = (trial_of(stage, PlainNearestFrontier()) for _ in range(2))
    assert np.array_equal(one.track, other.track)
    assert np.array_equal(one.curve, other.curve)

from __future__ import annotations

import numpy as np
from explore_bt_slam.contradiction import seen_through

from explore_bt.types import Pose2

TURN = np.linspace(-np.pi, np.pi, 360, endpoint=False)
CIRCLE = np.column_stack((np.cos(TURN), np.sin(TURN)))


def test_the_same_walls_contradict_nothing() -> None:
    pose = Pose2(3.0, -1.0, 0.7)
    assert seen_through(pose.apply(4.0 * CIRCLE), 4.0 * CIRCLE, pose) == 0.0


def test_a_wall_in_front_of_what_is_seen_contradicts_in_its_share() -> None:
    wall = np.column_stack((np.full(90, 1.5), np.linspace(-1.5, 1.5, 90)))
    mapped = np.vstack((4.0 * CIRCLE, wall))
    assert 0.1 < seen_through(mapped, 4.0 * CIRCLE, Pose2.identity()) < 0.3


def test_what_lies_behind_is_hidden_and_contradicts_nothing() -> None:
    assert seen_through(6.0 * CIRCLE, 4.0 * CIRCLE, Pose2.identity()) == 0.0

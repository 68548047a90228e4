"""Where a robot's map begins, and the truth as it looks from there."""

import math
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.sim2d import Sim2d

from explore_bt.interfaces import Driver, RobotContext
from explore_bt.runtime.origin import origin_of
from explore_bt.types import FREE, Pose2

WORLD = """\
format: explore-bt-world/1
rooms:
  - {name: long, box: [0, 0, 6, 2]}
  - {name: short, box: [0, 2, 2, 4]}
doors: [{name: d, at: [1, 2], width: 1.0}]
start: [1, 1, 0]
"""


@pytest.fixture
def world(tmp_path: Path) -> Path:
    file = tmp_path / "world.yaml"
    file.write_text(WORLD)
    return file


def driver(world: Path, start: Pose2 | None, **options: object) -> Driver:
    found = Sim2d(Sim2d.Options.model_validate({"world": world, **options}))
    found.setup(RobotContext(start=start))
    return found


def test_a_start_that_is_right_leaves_the_truth_as_it_is(world: Path) -> None:
    robot = driver(world, Pose2(1.0, 1.0, 0.5))
    origin = origin_of(robot, knows_start=True)
    assert origin.start == Pose2(1.0, 1.0, 0.5)
    assert origin.truth is robot.truth()
    assert origin.in_world(Pose2(3.0, 1.0, 0.0)) == Pose2(3.0, 1.0, 0.0)


@pytest.mark.parametrize("knows_start", [True, False])
def test_else_the_truth_is_told_in_the_robots_own_map(world: Path, knows_start: bool) -> None:
    told = Pose2(4.0, -3.0, 1.0) if knows_start else None
    robot = driver(world, told, stand=(1.5, 1.0, math.pi / 2))
    origin = origin_of(robot, knows_start)
    assert origin.start == (told or Pose2.identity())
    assert origin.truth is not None
    assert origin.truth.pose().distance_to(origin.start) < 1e-9
    back = origin.in_world(origin.truth.pose())
    assert back is not None
    assert back.distance_to(Pose2(1.5, 1.0, 0.0)) < 1e-9
    true = robot.truth()
    assert true is not None
    assert origin.truth.clearance_m() == true.clearance_m()
    drawn, moved = true.observable_floor(), origin.truth.observable_floor()
    assert np.count_nonzero(moved.free) == pytest.approx(np.count_nonzero(drawn.free), rel=0.01)
    assert origin.T_map_world is not None
    places = origin.T_map_world.apply(drawn.centers_of(np.argwhere(drawn.free)))
    found = [moved.value_at(x, y) == FREE for x, y in places.tolist()]
    assert np.mean(found) > 0.9, "but for cells at the rim, whose centres fall elsewhere"


def test_where_the_robot_stands_has_to_be_free(world: Path) -> None:
    with pytest.raises(Exception, match="nearest start that fits"):
        driver(world, None, stand=(6.0, 1.0, 0.0))

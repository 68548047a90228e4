from __future__ import annotations

from pathlib import Path

import pytest
from explore_bt_drivers import Sim2d, Sim2dOptions

from explore_bt.errors import WorldError
from explore_bt.interfaces import Resumption, RobotContext
from explore_bt.types import Battery, Imu, Pose2, Scan2D, Twist2

ROOM = Path(__file__).parents[2] / "missions" / "worlds" / "room.yaml"
STAND = Pose2(1.5, 2.0, 0.3)
CUT_S = 61.7


def resumed(pose: Pose2 = STAND, **options: object) -> Sim2d:
    driver = Sim2d(Sim2dOptions.model_validate({"world": ROOM, **options}))
    driver.setup(RobotContext(seed=3, resumed=Resumption(CUT_S, Pose2(0.0, 0.0, 0.0), pose)))
    return driver


def test_the_body_stands_where_it_was_and_the_clock_shows_when() -> None:
    driver = resumed()
    assert driver.clock.now_s() == CUT_S
    truth = driver.truth()
    assert truth is not None
    assert truth.pose().as_array() == pytest.approx(STAND.as_array())
    assert driver.start.xy == (1.0, 1.0)  # the mission's own
    assert driver.read() == []


def test_sensors_go_on_counting_from_there() -> None:
    driver = resumed(battery_life=600.0)
    driver.clock.wait_until(CUT_S + 1.0)
    measured = driver.read()
    assert min(each.stamp_s for each in measured) > CUT_S
    assert max(each.stamp_s for each in measured) <= CUT_S + 1.0
    assert sum(isinstance(each, Scan2D) for each in measured) == 10
    assert sum(isinstance(each, Imu) for each in measured) == 100
    charges = [each.charge for each in measured if isinstance(each, Battery)]
    assert charges == [pytest.approx(1.0 - 62.0 / 600.0)]


def test_it_drives_on_from_there() -> None:
    driver = resumed()
    for step in range(1, 21):
        driver.command(Twist2(0.3, 0.0))
        driver.clock.wait_until(CUT_S + 0.05 * step)
    truth = driver.truth()
    assert truth is not None
    assert 0.05 < truth.pose().distance_to(STAND) < 0.3
    assert truth.contacts() == 0


def test_a_place_where_something_stands_now_is_refused() -> None:
    with pytest.raises(WorldError, match="the run broke off at"):
        resumed(Pose2(0.7, 3.5, 0.0))

from __future__ import annotations

import pytest

from explore_bt.mission import LimitsSpec
from explore_bt.runtime.purse import Purse
from explore_bt.types import Battery


def test_no_limit_no_budget() -> None:
    assert Purse(LimitsSpec()).budgets(10.0, 5.0) == ()


def test_time_and_distance_are_what_is_left_of_the_limits() -> None:
    time, distance = Purse(LimitsSpec(time_s=60.0, distance_m=30.0)).budgets(10.0, 12.0)
    assert (time.name, time.left, time.need(9.0, 4.0)) == ("time", 50.0, 4.0)
    assert (distance.name, distance.left, distance.need(9.0, 4.0)) == ("distance", 18.0, 9.0)
    assert str(distance) == "18 of 30 m"


def test_the_battery_counts_from_its_first_word_down_to_the_reserve() -> None:
    purse = Purse(LimitsSpec(battery_reserve=0.2))
    assert purse.budgets(0.0, 0.0) == ()
    purse.take(Battery(0.0, 0.9))
    purse.take(Battery(100.0, 0.8))
    (battery,) = purse.budgets(100.0, 0.0)
    assert battery.whole == pytest.approx(70.0)
    assert battery.left == pytest.approx(60.0)
    assert battery.need(0.0, 50.0) == pytest.approx(5.0)  # 0.1 % a second
    assert str(battery) == "60 of 70 %"


def test_a_battery_that_was_heard_for_a_moment_only_tells_no_drain() -> None:
    purse = Purse(LimitsSpec(battery_reserve=0.0))
    purse.take(Battery(0.0, 1.0))
    purse.take(Battery(1.0, 0.9))
    (battery,) = purse.budgets(1.0, 0.0)
    assert battery.need(0.0, 50.0) == 0.0

import csv
import json
import os
from pathlib import Path

import pytest
from explore_bt_drivers import Sim2d, Sim2dOptions
from explore_bt_drivers.world import choose_start, load_world

from explore_bt.interfaces import RobotContext
from explore_bt.types import Pose2

DATA = Path(os.environ.get("EXPLORE_BT_DATA", "")) / "floorplans"
INDEX = DATA / "index.csv"
PLANS = (
    list(csv.DictReader(INDEX.read_text().splitlines()))
    if "EXPLORE_BT_DATA" in os.environ and INDEX.exists()
    else []
)

pytestmark = pytest.mark.skipif(not PLANS, reason="EXPLORE_BT_DATA does not name a folder with floor plans")


@pytest.mark.parametrize("plan", PLANS, ids=lambda plan: plan["name"])
def test_real_floor_plans_load_and_take_their_start_points(plan: dict[str, str]) -> None:
    world = load_world(DATA / plan["set"] / f"{plan['name']}.yaml")
    area = world.floor.free.sum() * world.floor.resolution_m**2
    assert area == pytest.approx(float(plan["free_m2"]), rel=0.001)
    starts = json.loads(plan["starts_xy_m"])
    assert len(starts) == 4
    for x, y in starts:
        assert choose_start(world, Pose2(x, y, 0.0), 0.25) == Pose2(x, y, 0.0)


def test_most_of_the_smallest_real_plan_can_be_explored() -> None:
    plan = min(PLANS, key=lambda plan: float(plan["free_m2"]))
    x, y = json.loads(plan["starts_xy_m"])[0]
    options = Sim2dOptions.model_validate({"world": DATA / plan["set"] / f"{plan['name']}.yaml"})
    driver = Sim2d(options)
    driver.setup(RobotContext(start=Pose2(x, y, 0.0)))
    truth = driver.truth()
    assert truth is not None
    floor = truth.observable_floor()
    assert floor.free.sum() * floor.resolution_m**2 > 0.9 * float(plan["component_m2"])

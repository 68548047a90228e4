"""The balancing robot on missions, with everything that belongs to them."""

import math

import pytest
from explore_bt_drivers.mujoco import Mujoco

from explore_bt.types import Outcome, Twist2

from .conftest import MISSIONS, RunMission, Watcher

ROOM = ("world=" + str(MISSIONS / "worlds/room.yaml"), "camera=off")


@pytest.mark.slow
def test_a_balancing_robot_that_is_pushed_over_is_stood_up_and_explores_the_room_by_3d_lidar(
    run: RunMission, monkeypatch: pytest.MonkeyPatch
) -> None:
    command, watcher = Mujoco.command, Watcher()

    def pushed(self: Mujoco, twist: Twist2) -> None:
        command(self, twist)
        base = self._running().data.body("base_link")
        is_pushed = 8.0 <= self.clock.now_s() < 8.1
        yaw = self.truth().pose().yaw_rad
        base.xfrc_applied[:2] = (500.0 * math.cos(yaw), 500.0 * math.sin(yaw)) if is_pushed else 0.0

    monkeypatch.setattr(Mujoco, "command", pushed)
    result = run("04_mujoco_flat.yaml", *ROOM, seed=2, sinks=[watcher])
    told = [event.message for event in watcher.events]
    assert any("a body that cannot drive: the robot has fallen" in message for message in told)
    assert any("is helped up" in message for message in told)
    assert result.outcome is Outcome.EXPLORED
    assert result.coverage is not None
    assert result.coverage >= 0.97
    assert result.distance_to_home_m <= 0.15

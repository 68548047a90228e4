"""The driver against a robot in another process, by the contract of all drivers."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

from collections.abc import Iterator
from pathlib import Path

import pytest
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options

from explore_bt.interfaces import Driver
from explore_bt.testing.driver_contract import DriverContract
from tests.ros2.worlds import HALL, robot_in


@pytest.fixture(scope="module", autouse=True)
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    world = tmp_path_factory.mktemp("world") / "hall.yaml"
    world.write_text(HALL)
    with robot_in(world, "--speed", "4"):
        yield


class TestRos2(DriverContract):
    """Behind it stands a robot that moves on between the tests."""

    def make(self, tmp_path: Path) -> Driver:
        return Ros2(Ros2Options(use_sim_time=True))

"""For the tests of plugin authors: one contract suite per kind, fakes, and what is installed.

Subclass a suite, say how to make your plugin, run pytest::

    from explore_bt.testing import PlannerContract

    class TestMyPlanner(PlannerContract):
        def make(self):
            return MyPlanner(MyPlanner.Options())
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

# at once: the module has the function's name, and would take its place if it were imported later
from explore_bt.testing.registered import registered

if TYPE_CHECKING:
    from explore_bt.testing.allocator_contract import AllocatorContract
    from explore_bt.testing.controller_contract import ControllerContract
    from explore_bt.testing.driver_contract import DriverContract
    from explore_bt.testing.fake_robot import FakeRobot
    from explore_bt.testing.planner_contract import PlannerContract
    from explore_bt.testing.slam_contract import SlamContract
    from explore_bt.testing.team_contract import TeamContract

__all__ = [
    "AllocatorContract",
    "ControllerContract",
    "DriverContract",
    "FakeRobot",
    "PlannerContract",
    "SlamContract",
    "TeamContract",
    "registered",
]

# imported on first use: a suite brings hypothesis or numba with it, which another author need not have
_HOME = {
    "AllocatorContract": "allocator_contract",
    "ControllerContract": "controller_contract",
    "DriverContract": "driver_contract",
    "FakeRobot": "fake_robot",
    "PlannerContract": "planner_contract",
    "SlamContract": "slam_contract",
    "TeamContract": "team_contract",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)

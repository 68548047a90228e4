"""A mission at work: robots, tick loop, safety gate, stop flag; and mapping from a log, without a robot."""

from explore_bt.runtime.attendant import Attendant
from explore_bt.runtime.exports import export
from explore_bt.runtime.mapping import HealthChange, Mapping, map_log
from explore_bt.runtime.mission_run import run_mission
from explore_bt.runtime.robot import Robot
from explore_bt.runtime.runner import Runner
from explore_bt.runtime.stop_flag import StopFlag

__all__ = [
    "Attendant",
    "HealthChange",
    "Mapping",
    "Robot",
    "Runner",
    "StopFlag",
    "export",
    "map_log",
    "run_mission",
]

"""A mission at work: robots, tick loop, safety gate, stop flag; and mapping from a log, without a robot."""

from explore_bt.runtime.exports import export
from explore_bt.runtime.mapping import HealthChange, Mapping, map_log
from explore_bt.runtime.mission_run import run_mission
from explore_bt.runtime.stop_flag import StopFlag

__all__ = ["HealthChange", "Mapping", "StopFlag", "export", "map_log", "run_mission"]

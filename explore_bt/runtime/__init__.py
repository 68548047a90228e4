"""A mission at work: robots, tick loop, safety gate, stop flag."""

from explore_bt.runtime.mission_run import run_mission
from explore_bt.runtime.stop_flag import StopFlag

__all__ = ["StopFlag", "run_mission"]

"""A mission at work: robots, tick loop, safety gate, stop flag; and mapping from a log, without a robot."""

from explore_bt.runtime.attendant import Attendant
from explore_bt.runtime.attendants import Attendants
from explore_bt.runtime.exports import export
from explore_bt.runtime.kept_values import RUN_FILE, codec_for, robot_file, run_codec, slam_folder
from explore_bt.runtime.mapping import HealthChange, Mapping, map_log
from explore_bt.runtime.mission_run import ENDING_KEYS, run_mission
from explore_bt.runtime.pace import Pace, pace_of
from explore_bt.runtime.resumption import Cut, CutRun
from explore_bt.runtime.robot import Robot
from explore_bt.runtime.robot_keeping import sort_of
from explore_bt.runtime.run_checkpoints import CHECKPOINTS
from explore_bt.runtime.runner import Runner
from explore_bt.runtime.stop_flag import StopFlag

__all__ = [
    "CHECKPOINTS",
    "ENDING_KEYS",
    "RUN_FILE",
    "Attendant",
    "Attendants",
    "Cut",
    "CutRun",
    "HealthChange",
    "Mapping",
    "Pace",
    "Robot",
    "Runner",
    "StopFlag",
    "codec_for",
    "export",
    "map_log",
    "pace_of",
    "robot_file",
    "run_codec",
    "run_mission",
    "slam_folder",
    "sort_of",
]

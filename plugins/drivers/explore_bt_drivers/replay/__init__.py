"""Recorded logs, played as a robot's measurements."""

from explore_bt_drivers.replay.carmen_log import CarmenLog
from explore_bt_drivers.replay.driver import Replay
from explore_bt_drivers.replay.log import MeasurementLog
from explore_bt_drivers.replay.open_log import open_log
from explore_bt_drivers.replay.options import ReplayOptions
from explore_bt_drivers.replay.stamps import ReplayTime

__all__ = ["CarmenLog", "MeasurementLog", "Replay", "ReplayOptions", "ReplayTime", "open_log"]

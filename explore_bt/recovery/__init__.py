"""What becomes of a run that broke off: going on with it, or saving what it left."""

from explore_bt.recovery.cut_run import BrokenOff, find_broken_off
from explore_bt.recovery.last_known import recorded_map, recorded_result, recorded_way
from explore_bt.recovery.moments import moments_of
from explore_bt.recovery.recover import Recovered, recover
from explore_bt.recovery.repair import repair

__all__ = [
    "BrokenOff",
    "Recovered",
    "find_broken_off",
    "moments_of",
    "recorded_map",
    "recorded_result",
    "recorded_way",
    "recover",
    "repair",
]

"""The leaves that put the exploration's mathematics into a tree, one a file."""

from explore_bt.behaviours.back_out import BackOut
from explore_bt.behaviours.budget_left import BudgetLeft
from explore_bt.behaviours.choose_home import ChooseHome
from explore_bt.behaviours.choose_place import ChoosePlace
from explore_bt.behaviours.clear_map import ClearMap
from explore_bt.behaviours.drive_to import DriveTo
from explore_bt.behaviours.find_frontier import FindFrontier
from explore_bt.behaviours.find_next_heading import FindNextHeading
from explore_bt.behaviours.find_view import FindView
from explore_bt.behaviours.give_up_goal import GivenUp, GiveUpGoal
from explore_bt.behaviours.leave_pocket import LeavePocket
from explore_bt.behaviours.make_way import MakeWay
from explore_bt.behaviours.record_waypoint import RecordWaypoint
from explore_bt.behaviours.reset_half_planes import ResetHalfPlanes
from explore_bt.behaviours.stand_up import StandUp
from explore_bt.behaviours.stop_requested import StopRequested
from explore_bt.behaviours.take_back import TakeBack
from explore_bt.behaviours.turn import Turn
from explore_bt.behaviours.wait import Wait
from explore_bt.behaviours.wait_for_team import WaitForTeam
from explore_bt.behaviours.wait_until_localised import WaitUntilLocalised
from explore_bt.behaviours.watch_progress import WatchProgress

__all__ = [
    "LEAVES",
    "BackOut",
    "BudgetLeft",
    "ChooseHome",
    "ChoosePlace",
    "ClearMap",
    "DriveTo",
    "FindFrontier",
    "FindNextHeading",
    "FindView",
    "GiveUpGoal",
    "GivenUp",
    "LeavePocket",
    "MakeWay",
    "RecordWaypoint",
    "ResetHalfPlanes",
    "StandUp",
    "StopRequested",
    "TakeBack",
    "Turn",
    "Wait",
    "WaitForTeam",
    "WaitUntilLocalised",
    "WatchProgress",
]

LEAVES = (
    BackOut,
    BudgetLeft,
    ChooseHome,
    ChoosePlace,
    ClearMap,
    DriveTo,
    FindFrontier,
    FindNextHeading,
    FindView,
    GiveUpGoal,
    LeavePocket,
    MakeWay,
    RecordWaypoint,
    ResetHalfPlanes,
    StandUp,
    StopRequested,
    TakeBack,
    Turn,
    Wait,
    WaitForTeam,
    WaitUntilLocalised,
    WatchProgress,
)

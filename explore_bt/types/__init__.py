"""Frozen values that travel between the parts of a robot's stack.

Frames are REP-105's ``map → odom → base_link``, units REP-103's: metres, radians, seconds.
"""

from explore_bt.types.body import BodyShape
from explore_bt.types.budget import Budget
from explore_bt.types.drawing import (
    Drawing,
    FrontierMark,
    HalfPlaneMark,
    SectorMark,
    Verdict,
    ViewMark,
)
from explore_bt.types.estimate import Estimate, Health, Trajectory
from explore_bt.types.fault import BodyFault, BodyFaultKind
from explore_bt.types.grid import FREE, OCCUPIED, UNKNOWN, GridWindow, OccupancyGrid
from explore_bt.types.mate import Doing, Mate
from explore_bt.types.measurement import (
    Battery,
    Imu,
    Measurement,
    PointCloud,
    RgbdFrame,
    Scan2D,
    WheelOdometry,
)
from explore_bt.types.motion import MotionLimits, MotionState
from explore_bt.types.moving import MovingObstacle
from explore_bt.types.path import Path, Waypoint, way_along
from explore_bt.types.pose import Pose2, Twist2, wrap_angle
from explore_bt.types.result import MappingResult, Outcome, Result, Score
from explore_bt.types.shared_graph import (
    STRETCH_KEYFRAMES,
    MapFit,
    SharedEdge,
    SharedKeyframe,
    SharedStretch,
)
from explore_bt.types.structure import MapStructure, PoseGraph2, Voxels

__all__ = [
    "FREE",
    "OCCUPIED",
    "STRETCH_KEYFRAMES",
    "UNKNOWN",
    "Battery",
    "BodyFault",
    "BodyFaultKind",
    "BodyShape",
    "Budget",
    "Doing",
    "Drawing",
    "Estimate",
    "FrontierMark",
    "GridWindow",
    "HalfPlaneMark",
    "Health",
    "Imu",
    "MapFit",
    "MapStructure",
    "MappingResult",
    "Mate",
    "Measurement",
    "MotionLimits",
    "MotionState",
    "MovingObstacle",
    "OccupancyGrid",
    "Outcome",
    "Path",
    "PointCloud",
    "Pose2",
    "PoseGraph2",
    "Result",
    "RgbdFrame",
    "Scan2D",
    "Score",
    "SectorMark",
    "SharedEdge",
    "SharedKeyframe",
    "SharedStretch",
    "Trajectory",
    "Twist2",
    "Verdict",
    "ViewMark",
    "Voxels",
    "Waypoint",
    "WheelOdometry",
    "way_along",
    "wrap_angle",
]

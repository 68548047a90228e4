"""A robot without a body: what a leaf's test needs of ``RobotServices``, set by plain assignment."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from explore_bt.errors import PlanningFailure
from explore_bt.fleet import Alone
from explore_bt.interfaces import ControlOutput, ControlStatus, HeldBy, MapView
from explore_bt.types import (
    FREE,
    BodyFault,
    Budget,
    Drawing,
    Estimate,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
    Scan2D,
    Trajectory,
    Twist2,
)

__all__ = ["FakePilot", "FakeRobot", "full_circle_scan", "open_floor"]


class FakePilot:
    """Notes what it was asked; the test sets ``output`` and ``blocked_s``."""

    def __init__(self) -> None:
        self.followed: list[Path] = []
        self.holds = 0
        self.output = ControlOutput(Twist2(), ControlStatus.IDLE)
        self.blocked_s = 0.0
        self.held_by = HeldBy.OBSTACLE
        self.gate_reason = ""
        self.body_fault: BodyFault | None = None
        self.can_recover = True
        self.recoveries = 0
        self.in_the_way = ""

    def recover_body(self) -> bool:
        """Count it; the fault stays until the test takes it away."""
        self.recoveries += 1
        return self.can_recover

    def follow(self, path: Path) -> None:
        """Remember the path; the status becomes ``running``."""
        self.followed.append(path)
        self.output = ControlOutput(Twist2(), ControlStatus.RUNNING)

    def hold(self) -> None:
        """Count it."""
        self.holds += 1

    def report(self, status: ControlStatus, reason: str = "") -> None:
        """Let the controller say something."""
        self.output = ControlOutput(Twist2(), status, reason)


class FakeRobot:
    """Implements ``RobotServices``; every attribute may be set by the test."""

    def __init__(self, grid: OccupancyGrid, pose: Pose2 = Pose2(0.0, 0.0, 0.0)) -> None:
        self.name = "robot"
        self.footprint_radius_m = 0.25
        self.least_margin_m = -0.03
        self.lidar_range_m = 5.0
        self.home = pose
        self.pilot = FakePilot()
        self.stop_requested = False
        self.distance_m = 0.0
        self.time_s = 0.0
        self.pose = pose
        self.grid = grid
        self.latest_scan: Scan2D | None = full_circle_scan()
        self.refusal: PlanningFailure | None = None
        self.driven: list[Pose2] = []
        self.avoided: list[tuple[float, float]] = []
        self.cleared: list[float] = []
        self.drawn: list[Drawing] = []
        self.limited: tuple[Budget, ...] = ()
        self.moving: tuple[MovingObstacle, ...] = ()
        self.team = Alone()

    def now_s(self) -> float:
        """``time_s``."""
        return self.time_s

    def budgets(self) -> tuple[Budget, ...]:
        """``limited``."""
        return self.limited

    def estimate(self) -> Estimate:
        """``pose``, healthy."""
        return Estimate(self.time_s, self.pose)

    def trajectory(self) -> Trajectory:
        """``driven`` and ``pose``, a tenth of a second apart."""
        poses = np.array([(p.x, p.y, p.yaw_rad) for p in (*self.driven, self.pose)])
        return Trajectory(np.linspace(0.0, 0.1 * len(self.driven), len(poses)), poses)

    def view(self) -> MapView:
        """``grid``."""
        return MapView(self.grid)

    def scan(self) -> Scan2D | None:
        """``latest_scan``."""
        return self.latest_scan

    def draw(self, drawing: Drawing) -> None:
        """Remember it in ``drawn``."""
        self.drawn.append(drawing)

    def avoid(self, position: tuple[float, float]) -> None:
        """Remember it in ``avoided``."""
        self.avoided.append(position)

    def clear_map(self, radius_m: float) -> bool:
        """Remember the radius in ``cleared``."""
        self.cleared.append(radius_m)
        return True

    def reopen(self, chances: int) -> int:  # noqa: ARG002  # a fake has no memory of chances
        """Empty ``avoided``, whatever the chances."""
        count = len(self.avoided)
        self.avoided.clear()
        return count

    def plan(self, goal: Pose2, via: Sequence[tuple[float, float]] = ()) -> Path:
        """Straight lines over all of them, or the ``refusal``."""
        if self.refusal is not None:
            raise self.refusal
        corners = (self.pose.xy, *via, goal.xy)
        legs = [np.linspace(*leg, 11)[:-1] for leg in pairwise(corners)]
        xys = np.vstack((*legs, goal.xy))
        return Path(np.column_stack((xys, np.full(len(xys), goal.yaw_rad))), np.ones(len(xys)))


def full_circle_scan(ranges_m: float | np.ndarray = np.inf, beams: int = 360, range_m: float = 5.0) -> Scan2D:
    """An instantaneous sweep of ``beams`` equal steps from -π; one range, or (beams,) of them, metres."""
    return Scan2D(
        stamp_s=0.0,
        angles_rad=-np.pi + np.arange(beams) * 2.0 * np.pi / beams,
        ranges_m=np.broadcast_to(np.asarray(ranges_m, dtype=np.float32), (beams,)).copy(),
        times_s=np.zeros(beams),
        range_min_m=0.05,
        range_max_m=range_m,
    )


def open_floor(size_m: float = 20.0, resolution_m: float = 0.1) -> OccupancyGrid:
    """A known free square about the origin, in unknown space that begins at its edge."""
    cells = round(size_m / resolution_m)
    return OccupancyGrid(
        np.full((cells, cells), FREE, dtype=np.int8), resolution_m, (-size_m / 2.0, -size_m / 2.0)
    )

"""Where a robot's map begins, and how the simulator's truth looks from there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Driver, GroundTruth, RobotContext
from explore_bt.types import UNKNOWN, MotionLimits, OccupancyGrid, Pose2

__all__ = ["Origin", "context_with", "origin_of"]


@dataclass(frozen=True, slots=True)
class Origin:
    """The robot's start in its own ``map`` frame, and the truth in that frame.

    Attributes:
        T_map_world: None where the two are one.
    """

    start: Pose2
    truth: GroundTruth | None
    T_map_world: Pose2 | None = None

    def in_world(self, pose: Pose2 | None) -> Pose2 | None:
        """A pose of the ``map`` frame as the simulator has it."""
        if pose is None or self.T_map_world is None:
            return pose
        return self.T_map_world.inverse().compose(pose)


def origin_of(driver: Driver, knows_start: bool) -> Origin:
    """Of a driver that is set up; a robot that does not know its start begins its map where it stands."""
    start = driver.start if knows_start else Pose2.identity()
    truth = driver.truth()
    stood = (truth.start() if truth is not None else None) or driver.start
    if truth is None or stood == start:
        return Origin(start, truth)
    T_map_world = start.compose(stood.inverse())
    return Origin(start, _Moved(truth, T_map_world), T_map_world)


def context_with(context: RobotContext, driver: Driver, origin: Origin, limits: MotionLimits) -> RobotContext:
    """What the other plugins are set up with, once the driver is ready."""
    return replace(
        context,
        start=origin.start,
        footprint_radius_m=driver.footprint_radius_m,
        limits=limits,
        shape=driver.shape,
        truth=origin.truth,
        connection=driver.connection,
    )


class _Moved(GroundTruth):
    """A truth in another frame."""

    def __init__(self, truth: GroundTruth, T_map_world: Pose2) -> None:
        self._truth = truth
        self._T = T_map_world

    def pose(self) -> Pose2:
        """Where the robot is now."""
        return self._T.compose(self._truth.pose())

    def contacts(self) -> int:
        """As the simulator counts."""
        return self._truth.contacts()

    def clearance_m(self) -> float:
        """As the simulator measures."""
        return self._truth.clearance_m()

    def observable_floor(self) -> OccupancyGrid:
        """Each cell is what lies at its centre."""
        floor = self._truth.observable_floor()
        rows, cols = floor.shape
        size = floor.resolution_m
        corners = np.array([[0, 0], [cols, 0], [cols, rows], [0, rows]]) * size + floor.origin_xy
        low, high = (f(self._T.apply(corners), axis=0) for f in (np.min, np.max))
        shape = tuple(np.ceil((high - low) / size).astype(int).tolist()[::-1])
        blank = np.full(shape, UNKNOWN, dtype=np.int8)
        moved = OccupancyGrid(blank, size, (float(low[0]), float(low[1])), floor.revision)
        cells = np.argwhere(np.ones(shape, dtype=np.bool_))
        there = self._T.inverse().apply(moved.centers_of(cells))
        at = np.floor((there - floor.origin_xy) / size).astype(int)[:, ::-1]
        inside = ((at >= 0) & (at < floor.shape)).all(axis=1)
        values = np.full(len(cells), UNKNOWN, dtype=np.int8)
        values[inside] = floor.cells[tuple(at[inside].T)]
        return replace(moved, cells=values.reshape(shape))

    def people(self) -> NDArray[np.float64]:
        """Everybody who is about now."""
        people = self._truth.people().copy()
        people[:, :2] = self._T.apply(people[:, :2])
        people[:, 2:4] = Pose2(0.0, 0.0, self._T.yaw_rad).apply(people[:, 2:4])
        return people

    def touched_by_people(self) -> int:
        """As the simulator counts."""
        return self._truth.touched_by_people()

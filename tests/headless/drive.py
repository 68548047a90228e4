"""A loop of somebody else's: a plain lidar over a true map, and a robot that goes along the path."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from explore_bt import Decision, Explorer
from explore_bt.exploration import scan_of_grid
from explore_bt.types import FREE, UNKNOWN, OccupancyGrid, Pose2

STEP_M = 0.5


def look(truth: OccupancyGrid, known: np.ndarray, pose: Pose2, range_m: float = 5.0) -> None:
    """Enter what a lidar sees: cells on straight lines of floor, and the first obstacle on each."""
    scan = scan_of_grid(truth, pose, range_m, beams=720)
    reach = np.minimum(scan.ranges_m.astype(float), range_m)
    along = np.arange(0.0, range_m, 0.4 * truth.resolution_m)
    headings = scan.angles_rad + pose.yaw_rad
    for heading, free_m, hit in zip(headings, reach, scan.is_return, strict=True):
        beside = np.array([np.cos(heading), np.sin(heading)])
        steps = np.append(along[along < free_m], [free_m + 1e-3] * bool(hit))
        cells = truth.cells_of(pose.xy + steps[:, None] * beside)
        cells = cells[((cells >= 0) & (cells < truth.shape)).all(axis=1)]
        known[tuple(cells.T)] = truth.cells[tuple(cells.T)]


def explore(
    explorer: Explorer, truth: OccupancyGrid, start: Pose2, most: int = 400
) -> Iterator[tuple[OccupancyGrid, Pose2, Decision]]:
    """Every decision with the map and pose it was made for; ends with the one that says done."""
    known = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    pose = start
    for revision in range(most):
        look(truth, known, pose)
        grid = OccupancyGrid(known.copy(), truth.resolution_m, truth.origin_xy, revision)
        decision = explorer.decide(grid, pose)
        yield grid, pose, decision
        if decision.done:
            return
        assert decision.path is not None
        pose = advanced(decision, pose)


def advanced(decision: Decision, pose: Pose2) -> Pose2:
    """Half a metre farther along the path."""
    assert decision.path is not None
    poses = decision.path.poses
    nearest = int(np.argmin(np.hypot(*(poses[:, :2] - pose.xy).T)))
    steps = np.hypot(*np.diff(poses[nearest:, :2], axis=0).T)
    there = nearest + int(np.searchsorted(np.cumsum(steps), STEP_M))
    return Pose2(*poses[min(there, len(poses) - 1)].tolist())


def share_seen(truth: OccupancyGrid, grid: OccupancyGrid) -> float:
    """Of the free cells of a map."""
    return float((grid.free & truth.free).sum() / (truth.cells == FREE).sum())

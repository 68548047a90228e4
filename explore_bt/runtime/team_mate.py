"""What keeps the robot clear of its team mates: they are where they say, and stop where they say."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import PlanningFailure
from explore_bt.types import OCCUPIED, Mate, OccupancyGrid, Path, Pose2, Scan2D

__all__ = ["fault_by_mates", "first_path", "grids_to_try", "standing", "with_mates", "without_mates"]

_OFF_M = 0.15
"""A return so near to a mate's disc is its own: poses, a sweep's motion and noise are off by less."""
_SURE_S = 0.5
"""Where a mate is by an older word nobody knows so well: its returns stay in the scan, as a stranger's."""
_MARGIN_M = 0.05
_GROWTH = 2.0
"""How fast the place where a mate may stop grows when its word is old, in its speed limit: it drives on, and
faster, and so needs longer."""
_FAR_M = 4.0
_ROOM_M = _MARGIN_M + 0.03
"""A plan passes a mate so far off that the gate will not mind, cells and all."""
_SLACK_M = 1e-3
_OFF_SHARE = 0.1
"""A way leads off if it gains so much of its length in room: the first that a robot at rest can drive is no
tenth of a millimetre."""


def fault_by_mates(
    way: NDArray[np.float64], radius_m: float, mates: Sequence[Mate], now_s: float
) -> tuple[str, str]:
    """Why a way to rest must not be driven, and because of whom; both empty if it may.

    Every robot keeps the places free where another passes if it brakes now, and tells its own before others
    decide. So two can always stop without meeting, whoever goes first. A way that begins too near to someone
    may lead off.

    Args:
        way: (N, 3) float64, poses from here to rest, ``map`` frame.
        radius_m: of the own footprint.
        mates: who was heard of lately.
        now_s: on the clock of their stamps.
    """
    gain_m = min(_SLACK_M, _OFF_SHARE * float(np.hypot(*np.diff(way[:, :2], axis=0).T).sum()))
    for mate in mates:
        late_s = max(now_s - mate.binding_s, 0.0)
        needed_m = radius_m + mate.radius_m + _MARGIN_M + _GROWTH * mate.speed_limit_mps * late_s
        if np.hypot(*(way[0, :2] - mate.T_map_base.xy)) > needed_m + _FAR_M:
            continue
        apart = way[:, None, :2] - mate.stop[None]
        room_m = np.hypot(apart[..., 0], apart[..., 1]).min(axis=1)
        worst_m = float(room_m.min())
        if worst_m >= needed_m:
            continue
        if worst_m < min(needed_m, room_m[0]) - _SLACK_M or room_m[-1] < room_m[0] + gain_m:
            return f"team mate {mate.name} stops {worst_m - radius_m - mate.radius_m:.2f} m away", mate.name
    return "", ""


def without_mates(scan: Scan2D, pose: Pose2, mates: Sequence[Mate]) -> Scan2D:
    """The scan with every return off a team mate made invalid: it is no part of the map, and nobody unknown.

    Args:
        scan: as measured.
        pose: of the robot at its stamp, ``map`` frame.
        mates: who was heard of lately.
    """
    mates = [mate for mate in mates if scan.stamp_s - mate.stamp_s < _SURE_S]
    if not mates:
        return scan
    bearings = scan.angles_rad + pose.yaw_rad
    ranges = np.where(scan.is_return, scan.ranges_m, np.nan).astype(np.float64)
    x = pose.x + ranges * np.cos(bearings)
    y = pose.y + ranges * np.sin(bearings)
    hit = np.zeros(len(ranges), dtype=np.bool_)
    for mate in mates:
        at = mate.at(scan.stamp_s)
        hit |= np.hypot(x - at[0], y - at[1]) < mate.radius_m + _OFF_M
    if not hit.any():
        return scan
    cleared = scan.ranges_m.copy()
    cleared[hit] = np.nan
    cleared.flags.writeable = False
    return replace(scan, ranges_m=cleared)


def standing(mates: Sequence[Mate], here: Pose2, goal: Pose2, right_of_way: tuple[int, str]) -> list[Mate]:
    """The mates to plan around: who stands and has nowhere to go, and near by who stands and goes first.

    Who stands on the goal is none: it may be gone by then.
    """
    mates = [mate for mate in mates if _distance_m(mate, goal) > 2.0 * mate.radius_m + _ROOM_M]
    near = [mate for mate in mates if _distance_m(mate, here) < _FAR_M]
    first = [mate for mate in near if mate.right_of_way < right_of_way and mate.is_standing]
    return list({mate.name: mate for mate in (*(mate for mate in mates if mate.is_parked), *first)}.values())


def grids_to_try(
    grid: OccupancyGrid, around: Sequence[Mate], here: Pose2, radius_m: float
) -> Sequence[OccupancyGrid]:
    """The map with all mates to plan around, and without the parked: they may be gone by then."""
    first = [mate for mate in around if not mate.is_parked]
    found = [with_mates(grid, around, here, radius_m)]
    return found if len(first) == len(around) else [*found, with_mates(grid, first, here, radius_m)]


def first_path(
    grids: Sequence[OccupancyGrid], plan: Callable[[OccupancyGrid], Path]
) -> tuple[OccupancyGrid, Path]:
    """A path on the first map that has one.

    Raises:
        PlanningFailure: what is said of the last map.
    """
    for grid in grids[:-1]:
        with contextlib.suppress(PlanningFailure):
            return grid, plan(grid)
    return grids[-1], plan(grids[-1])


def _distance_m(mate: Mate, pose: Pose2) -> float:
    return mate.T_map_base.distance_to(pose)


def with_mates(grid: OccupancyGrid, mates: Sequence[Mate], here: Pose2, radius_m: float) -> OccupancyGrid:
    """The map with mates as obstacles; the robot's own place stays free."""
    if not mates:
        return grid
    cells = grid.cells.copy()
    for mate in mates:
        x, y = mate.T_map_base.xy
        gap_m = np.hypot(here.x - x, here.y - y) - radius_m - grid.resolution_m
        reach_m = min(mate.radius_m + _ROOM_M, gap_m)
        window = grid.window_around(x, y, mate.radius_m + _ROOM_M + grid.resolution_m)
        part = cells[window.slices]
        local = np.argwhere(np.ones(part.shape, dtype=np.bool_))
        off_m = grid.centers_of(local + np.array([window.row0, window.col0])) - (x, y)
        part[np.hypot(off_m[:, 0], off_m[:, 1]).reshape(part.shape) <= reach_m] = OCCUPIED
    return replace(grid, cells=cells)

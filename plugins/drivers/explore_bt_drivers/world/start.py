"""Where a simulated robot begins."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from explore_bt.errors import WorldError
from explore_bt.interfaces import Resumption
from explore_bt.types import Pose2
from explore_bt_drivers.world.observable import fitting_cells, reachable_cells
from explore_bt_drivers.world.world import World

__all__ = ["Taken", "choose_start", "stand_of", "widest_spot"]

_TOUCH_M = 1e-6
_MENDED_M = 0.02
"""So much nearer to a thing may a pose that went through a recording be."""
_SPARE_M = 0.05
_APART_M = 0.7
"""What is left between robots that begin side by side: one more can pass between them."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A place where a robot begins; metres."""

    xy: tuple[float, float]
    radius_m: float


def choose_start(
    world: World, wanted: Pose2 | None, radius_m: float, others: Mapping[str, Taken] | None = None
) -> Pose2:
    """The pose to begin with: as wanted, else as the world's file says, else the widest spot.

    Where another robot has taken a place that nobody asked for by name, the nearest one beside it.

    Args:
        world: where.
        wanted: as the mission says.
        radius_m: of the footprint.
        others: who stands there already, by name.

    Raises:
        WorldError: the footprint does not fit there; names the nearest place where it does.
    """
    others = others or {}
    start = wanted or world.start or widest_spot(world, radius_m)
    if wanted is None and others:
        start = _beside(world, start, radius_m, others)
    if not all(math.isfinite(value) for value in (start.x, start.y, start.yaw_rad)):
        raise WorldError(f"{world.source}: the start {_xy(start)} is not a place; give finite numbers")
    clearance, thing = world.nearest_thing(start.x, start.y)
    if clearance < radius_m - _TOUCH_M:
        where = "lies inside" if clearance == 0.0 else f"is {clearance:.2f} m from"
        raise WorldError(
            f"{world.source}: the start {_xy(start)} {where} {thing}; "
            f"the robot's radius of {radius_m:g} m needs {radius_m:g} m clearance. "
            f"{_nearest_fit(world, start, radius_m)}"
        )
    for name, other in others.items():
        gap_m = math.dist(other.xy, start.xy) - other.radius_m - radius_m
        if gap_m < _TOUCH_M:
            raise WorldError(
                f"{world.source}: the start {_xy(start)} is taken: robot {name} stands "
                f"{max(gap_m + radius_m, 0.0):.2f} m from it, the radius is {radius_m:g} m. Give the robots "
                f"starts that are {other.radius_m + radius_m:.2f} m or more apart, or none"
            )
    return start


def _beside(world: World, start: Pose2, radius_m: float, others: Mapping[str, Taken]) -> Pose2:
    """The nearest place to a start that leaves the others room to turn and go; itself if it does."""
    cells = np.argwhere(reachable_cells(world, start.xy, radius_m + _SPARE_M))
    places = np.vstack((start.xy, world.floor.centers_of(cells)))
    for other in others.values():
        apart_m = np.hypot(*(places - other.xy).T) - other.radius_m - radius_m
        places = places[apart_m >= _APART_M]
    if not len(places):
        raise WorldError(
            f"{world.source}: there is no room for another robot of radius {radius_m:g} m beside "
            f"{', '.join(others)}; give each robot a start"
        )
    x, y = places[int(np.argmin(np.hypot(*(places - start.xy).T)))].tolist()
    return Pose2(x, y, start.yaw_rad)


def stand_of(world: World, resumed: Resumption | None, radius_m: float) -> Pose2 | None:
    """Where a resumed run left the robot; None for one that begins.

    Raises:
        WorldError: something stands there now.
    """
    if resumed is None:
        return None
    stand = resumed.true_pose or resumed.pose
    clearance_m, thing = world.nearest_thing(stand.x, stand.y)
    if clearance_m < radius_m - _MENDED_M and not world.things:  # things stand elsewhere by then
        raise WorldError(
            f"{world.source}: the run broke off at ({stand.x:.2f}, {stand.y:.2f}), {clearance_m:.2f} m from "
            f"{thing} as it stands now; the robot's radius is {radius_m:g} m. Give the world as it was"
        )
    return stand


def widest_spot(world: World, radius_m: float) -> Pose2:
    """The floor cell's centre that is farthest from everything (the first such one), facing along x.

    Where floor is in several pieces, as behind walls and windows, it is the one with most room for the robot.
    """
    fitting = fitting_cells(world, radius_m).astype(np.uint8)
    _, labels, figures, _ = cv2.connectedComponentsWithStats(fitting, connectivity=8)
    pieces = figures[1:, cv2.CC_STAT_AREA]
    in_largest = labels == 1 + int(np.argmax(pieces)) if len(pieces) else world.floor.free
    free = np.pad(world.floor.free.astype(np.uint8), 1)
    distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    distance = np.where(in_largest, distance, 0.0)
    row, col = np.unravel_index(int(np.argmax(distance)), distance.shape)
    return Pose2(*world.floor.center_of(int(row), int(col)), 0.0)


def _nearest_fit(world: World, start: Pose2, radius_m: float) -> str:
    cells = np.argwhere(fitting_cells(world, radius_m))
    if len(cells) == 0:
        return f"No place in this world is wide enough for a radius of {radius_m:g} m: make it smaller"
    centers = world.floor.centers_of(cells)
    nearest = int(np.argmin(np.hypot(centers[:, 0] - start.x, centers[:, 1] - start.y)))
    x, y = (float(value) for value in centers[nearest])
    return f"The nearest start that fits is [{x:.3f} m, {y:.3f} m, {math.degrees(start.yaw_rad):.0f} deg]"


def _xy(pose: Pose2) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f})"

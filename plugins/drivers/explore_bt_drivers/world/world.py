"""A world as robots meet it: exact segments, names of things, and the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.errors import WorldError
from explore_bt.maps import MarkedFile, read_map
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid, Pose2
from explore_bt_drivers.world.index import SegmentIndex, build_index, cast_rays, nearest, winding
from explore_bt_drivers.world.outline import grid_outline
from explore_bt_drivers.world.plan import Person, Thing, WorldPlan
from explore_bt_drivers.world.solid import box_corners, materials_of, outline_edges
from explore_bt_drivers.world.world_file import read_world_file

__all__ = ["World", "floor_like", "load_world"]

_FLOOR_RESOLUTION_M = 0.05
_LARGEST_AREA_M2 = 100_000.0


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """Geometry in the ``map`` frame as drawn; immutable, so that robots can share it.

    Attributes:
        index: all segments, solid on their left.
        owners: (M,) int32, for each segment the place of its thing in ``names``.
        floor: cells of 0.05 m (or the map file's) into which nothing solid reaches: ``FREE``.
        start: where the world's file says that robots begin.
        fixed: so many segments come first that never change; those of ``things`` follow.
        things: what changes in the course of time.
        people: who walks there.
        plan: the world file's content, heights included; None for a map, which has none.
    """

    source: Path
    index: SegmentIndex
    owners: NDArray[np.int32]
    names: tuple[str, ...]
    floor: OccupancyGrid
    start: Pose2 | None = None
    fixed: int = 0
    things: tuple[Thing, ...] = ()
    people: tuple[Person, ...] = ()
    plan: WorldPlan | None = None

    def is_free(self, x: float, y: float) -> bool:
        """Whether a point (metres) lies in no solid and within the world."""
        return bool(winding(self.index.segments, x, y) == -1)

    def clearance_m(self, x: float, y: float) -> float:
        """Exact distance from a point to the nearest solid; 0 inside one."""
        return self.nearest_thing(x, y)[0]

    def nearest_thing(self, x: float, y: float) -> tuple[float, str]:
        """Exact distance to the nearest solid, metres, and its name; 0 inside one."""
        distance, segment = nearest(self.index, x, y, math.inf)
        if self.is_free(x, y):
            return (float(distance), self.names[self.owners[segment]])
        for owner, name in enumerate(self.names):
            if winding(self.index.segments[self.owners == owner], x, y) > 0:
                return (0.0, name)
        return (0.0, self.names[self.owners[segment]])

    def cast(
        self, x: float, y: float, angles_rad: NDArray[np.float64], limit_m: float
    ) -> NDArray[np.float64]:
        """(N,) float64 exact ranges along (N,) world angles; +inf where nothing stands within the limit.

        As a lidar has them: through glass, and by way of mirrors.
        """
        return np.asarray(cast_rays(self.index, x, y, angles_rad, limit_m))


def load_world(path: Path) -> World:
    """Read a world: our own YAML, or a map_server map (whose YAML has a key ``image``).

    On a map, what is not free is solid: black, grey, and everything outside the picture.

    Raises:
        WorldError: the file is faulty, or leaves a robot no free floor.
    """
    root = MarkedFile(path).root("a world (format: explore-bt-world/1) or a map_server map (image: ...)")
    keys = {str(key.value) for key, _ in root.value}
    world = _from_map(path) if "image" in keys and "format" not in keys else _from_plan(path)
    if not world.floor.free.any():
        raise WorldError(
            f"{path}: has no free floor; everything is solid or unknown. Check the greys and thresholds of a "
            "map, or the size of rooms and furniture"
        )
    return world


def _check_size(path: Path, width_m: float, height_m: float) -> None:
    if width_m * height_m > _LARGEST_AREA_M2:
        raise WorldError(
            f"{path}: the world is {width_m:g} m by {height_m:g} m, more than {_LARGEST_AREA_M2:g} m² can be "
            "simulated; bare numbers are metres, write 5 cm or 0.05 for centimetres"
        )


def _from_map(path: Path) -> World:
    grid = read_map(path)
    _check_size(path, grid.shape[1] * grid.resolution_m, grid.shape[0] * grid.resolution_m)
    segments = grid_outline(~grid.free, grid.resolution_m, grid.origin_xy)
    floor = OccupancyGrid(
        np.where(grid.free, FREE, OCCUPIED).astype(np.int8), grid.resolution_m, grid.origin_xy
    )
    if len(segments) == 0:  # all solid: the caller refuses it
        segments = np.zeros((1, 4))
    index = build_index(segments)
    return World(
        path, index, np.zeros(len(segments), dtype=np.int32), ("a wall",), floor, fixed=len(segments)
    )


def _from_plan(path: Path) -> World:
    plan = read_world_file(path)
    _check_size(path, plan.bounds[2] - plan.bounds[0], plan.bounds[3] - plan.bounds[1])
    moved = {solid for thing in plan.things for solid in thing.stands[0].solids}
    fixed = [solid for solid in plan.solids if solid not in moved]
    solids = [*fixed, *(solid for solid in plan.solids if solid in moved)]
    edge = box_corners(*plan.bounds)[::-1]
    outlines = [edge, *(solid.corners for solid in solids)]
    segments = np.concatenate([outline_edges(corners) for corners in outlines])
    ever = [solid.name for thing in plan.things for stand in thing.stands for solid in stand.solids]
    names = tuple(dict.fromkeys(["the edge of the world", *(solid.name for solid in plan.solids), *ever]))
    owners = [0, *(names.index(solid.name) for solid in solids)]
    lengths = [len(corners) for corners in outlines]
    materials = np.concatenate((np.zeros(len(edge), dtype=np.int8), materials_of(solids)))
    index = build_index(np.ascontiguousarray(segments), materials)
    return World(
        path,
        index,
        np.repeat(owners, lengths).astype(np.int32),
        names,
        _floor_of(index, plan),
        plan.start,
        sum(lengths[: 1 + len(fixed)]),
        plan.things,
        plan.people,
        plan,
    )


def _floor_of(index: SegmentIndex, plan: WorldPlan) -> OccupancyGrid:
    size = _FLOOR_RESOLUTION_M
    x0, y0 = (math.floor(value / size + 1e-9) * size for value in plan.bounds[:2])
    cols = math.ceil((plan.bounds[2] - x0) / size - 1e-9)
    rows = math.ceil((plan.bounds[3] - y0) / size - 1e-9)
    return floor_like(OccupancyGrid(np.zeros((rows, cols), dtype=np.int8), size, (x0, y0)), index)


def floor_like(grid: OccupancyGrid, index: SegmentIndex) -> OccupancyGrid:
    """The floor that segments leave free, in the cells of another grid."""
    (x0, y0), (rows, cols) = grid.origin_xy, grid.shape
    cells = _free_cells(index, x0, y0, grid.resolution_m, rows, cols)
    return OccupancyGrid(np.where(cells, FREE, OCCUPIED).astype(np.int8), grid.resolution_m, grid.origin_xy)


@njit(cache=True)
def _free_cells(index, x0, y0, size, rows, cols):  # type: ignore[no-untyped-def]  # kernel
    """(rows, cols) bool: cells whose centre is free and half a cell away from everything."""
    free = np.zeros((rows, cols), dtype=np.bool_)
    for row in range(rows):
        for col in range(cols):
            x, y = x0 + (col + 0.5) * size, y0 + (row + 0.5) * size
            distance, _ = nearest(index, x, y, size)
            free[row, col] = distance >= 0.5 * size - 1e-6 and winding(index.segments, x, y) == -1
    return free

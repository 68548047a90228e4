"""Voxel submaps: evidence in three dimensions that moves with the graph.

A submap belongs to a keyframe. It is a square of bricks, made only where something was seen, so memory grows
with the area seen. All submaps share one pool of bricks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.levelling import LevelCloud, virtual_scan
from explore_bt.types import GridWindow, Pose2
from explore_bt_slam.projection import mark_columns, project
from explore_bt_slam.voxel_kernels import BRICK, DECISIVE, allocate, take_in, trace

__all__ = ["Columns", "Heights", "Submap", "VoxelMap"]

_BELOW_FLOOR_M = 0.1
_SURFACE_DEPTH = 0.4  # voxels; see Canvas
_FIRST_POOL = 64


@dataclass(frozen=True, slots=True)
class Heights:
    """Metres above the floor: below ``low_m`` is floor, up to ``high_m`` is in the robot's way."""

    low_m: float
    high_m: float
    top_m: float


@dataclass(slots=True)
class Submap:
    """Where a submap hangs; ``relative`` is ``T_keyframe_submap``, ``used`` when it last learnt."""

    keyframe: int
    relative: Pose2
    used: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """Some columns of a submap: (r, c) bool, and row and column of its first in the submap."""

    slot: int
    mask: NDArray[np.bool_]
    row0: int
    col0: int


class VoxelMap:
    """All submaps.

    Args:
        cell_m: side of a voxel.
        lidar_m: how far from the robot a beam ends at most.
        wander_m: how far the robot goes from a submap's centre while it learns; what it sees beyond that and
            ``lidar_m``, along x or y, is not taken in.
        heights: of floor and obstacle band.
        body_radius_m: the floor under the robot's disc is known, though no beam reaches it.
        clear_start_m: so is that of a disc of this radius at the first sweep, as far as the lidar sees.
    """

    def __init__(
        self,
        cell_m: float,
        lidar_m: float,
        wander_m: float,
        heights: Heights,
        body_radius_m: float,
        clear_start_m: float = 0.0,
    ) -> None:
        self.cell_m = cell_m
        self.submaps: list[Submap] = []
        self._body_m = body_radius_m
        self._clear_start_m, self._heights = clear_start_m, heights
        self._bottom_m = -math.ceil(_BELOW_FLOOR_M / cell_m) * cell_m
        low, high, top = (
            round((height - self._bottom_m) / cell_m)
            for height in (heights.low_m, heights.high_m, heights.top_m)
        )
        self._low, self._high = low, max(high, low + 1)
        levels = max(top, self._high)
        self._blocks = 2 * math.ceil((lidar_m + wander_m) / (cell_m * BRICK))
        self._tables = np.zeros((0, self._blocks, self._blocks), np.int32)
        self._pool = np.zeros((_FIRST_POOL, BRICK, BRICK, levels), np.int8)
        self._bricks = 0
        self._uses = 0
        self._box = min(2 * math.ceil(lidar_m / cell_m) + 4, self._blocks * BRICK)
        self._scratch = np.zeros((self._box, self._box, levels), np.uint8)
        self._touched = np.zeros((self._box, self._box), np.bool_)

    @property
    def memory_bytes(self) -> int:
        """What the evidence takes."""
        return self._pool.nbytes + self._tables.nbytes + self._scratch.nbytes

    @property
    def _half(self) -> int:
        return self._blocks * BRICK // 2

    def add_submap(self, keyframe: int, relative: Pose2) -> int:
        """A new, empty one."""
        self.submaps.append(Submap(keyframe, relative))
        blank = np.full((1, self._blocks, self._blocks), -1, np.int32)
        self._tables = np.concatenate((self._tables, blank))
        return len(self.submaps) - 1

    def learn(self, slot: int, cloud: LevelCloud, velocity_mps: NDArray[np.float64], pose: Pose2) -> Columns:
        """Take a sweep into a submap.

        Args:
            slot: which.
            cloud: the sweep.
            velocity_mps: (2,) of the robot during it, base axes.
            pose: of the base at the stamp, in the submap's axes.

        Returns:
            The columns in which something changed.
        """
        origins, ends = cloud.moved(velocity_mps)
        row0, col0 = (self._first(value) for value in (pose.y, pose.x))
        corner = (np.array([col0, row0, 0.0]) - [self._half, self._half, 0.0]) * self.cell_m
        corner[2] = self._bottom_m
        depth_m = _SURFACE_DEPTH * self.cell_m
        scratch, touched = self._scratch, self._touched
        trace(origins, ends, pose.as_array(), corner, self.cell_m, depth_m, scratch, touched)
        at_m = (pose.x - corner[0], pose.y - corner[1])
        self._know(self._disc(at_m, self._body_m))
        if self._uses == 0 and self._clear_start_m > 0.0:
            self._know(self._disc(at_m, self._clear_start_m) & self._in_sight(cloud, at_m, pose.yaw_rad))
        self._bricks = allocate(touched, row0, col0, self._tables[slot], self._bricks)
        if self._bricks > self._pool.shape[0]:
            more = np.zeros((max(self._bricks, 3 * self._pool.shape[0] // 2), *self._pool.shape[1:]), np.int8)
            more[: self._pool.shape[0]] = self._pool
            self._pool = more
        dirty = np.empty(touched.shape, np.bool_)
        take_in(scratch, touched, row0, col0, self._tables[slot], self._pool, dirty)
        self._uses += 1
        self.submaps[slot].used = self._uses
        return Columns(slot, dirty, row0, col0)

    def all_columns(self, slot: int) -> Columns:
        """Every column of a submap that has a brick."""
        mask = np.repeat(np.repeat(self._tables[slot] >= 0, BRICK, axis=0), BRICK, axis=1)
        return Columns(slot, mask, 0, 0)

    def bounds(self, columns: Columns, pose: Pose2) -> NDArray[np.float64] | None:
        """(4,) x0, y0, x1, y1 in metres about columns of a submap at ``pose``; None if there are none."""
        rows, cols = (np.flatnonzero(columns.mask.any(axis=axis)) for axis in (1, 0))
        if not rows.size:
            return None
        x0, x1 = (np.array([cols[0], cols[-1] + 1]) + columns.col0 - self._half) * self.cell_m
        y0, y1 = (np.array([rows[0], rows[-1] + 1]) + columns.row0 - self._half) * self.cell_m
        moved = pose.apply(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]))
        return np.concatenate((moved.min(axis=0), moved.max(axis=0)))

    def mark(
        self, columns: Columns, pose: Pose2, wanted: NDArray[np.bool_], corner: NDArray[np.float64]
    ) -> None:
        """See ``mark_columns``."""
        where = (self._half, columns.mask, columns.row0, columns.col0)
        mark_columns(wanted, corner, self.cell_m, pose.as_array(), *where)

    def draw(
        self,
        cells: NDArray[np.int8],
        wanted: NDArray[np.bool_],
        corner: NDArray[np.float64],
        order: Sequence[int],
        poses: NDArray[np.float64],
    ) -> GridWindow:
        """Classify cells anew, see ``project``; returns where a class changed."""
        changed = np.array([2**31, 2**31, 0, 0], dtype=np.int64)
        evidence = (self._tables, self._pool, self._half, self._low, self._high)
        slots = np.array(order, dtype=np.int64)
        project(cells, wanted, corner, self.cell_m, slots, poses, *evidence, changed)
        return GridWindow(*map(int, changed))

    def newest_first(self) -> list[int]:
        """Submaps in the order in which their word counts."""
        return sorted(range(len(self.submaps)), key=lambda slot: -self.submaps[slot].used)

    def voxels(self, poses: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Every known voxel in the ``map`` frame.

        Args:
            poses: (S, 3) of the submaps.

        Returns:
            (N, 3) int32 numbers along x, y, z (voxel 0 begins at the origin), sorted; (N,) float32 log-odds.
        """
        keys, values = [np.zeros((0, 3), np.int32)], [np.zeros(0, np.int8)]
        for slot in self.newest_first():
            rows, cols = np.nonzero(self._tables[slot] >= 0)
            bricks = self._pool[self._tables[slot, rows, cols]]
            at, r, c, level = np.nonzero(bricks)
            centres = np.column_stack((cols[at] * BRICK + c, rows[at] * BRICK + r)) + 0.5 - self._half
            xy = Pose2(*poses[slot].tolist()).apply(centres * self.cell_m)
            z = np.round(level + self._bottom_m / self.cell_m)
            keys.append(np.column_stack((np.floor(xy / self.cell_m + 1e-6), z)).astype(np.int32))
            values.append(bricks[at, r, c, level])
        key, value = np.concatenate(keys), np.concatenate(values)
        vague = (np.abs(value.astype(np.int16)) < DECISIVE).astype(np.int8)
        chosen = np.lexsort((np.arange(key.shape[0]), vague, key[:, 2], key[:, 1], key[:, 0]))
        key, value = key[chosen], value[chosen]
        first = np.ones(key.shape[0], np.bool_)
        first[1:] = (key[1:] != key[:-1]).any(axis=1)
        return key[first], value[first].astype(np.float32) / 10.0

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All that ``restore`` needs."""
        return {
            "voxel_tables": self._tables,
            "voxel_pool": self._pool[: self._bricks],
            "voxel_submaps": np.array(
                [(s.keyframe, s.relative.x, s.relative.y, s.relative.yaw_rad, s.used) for s in self.submaps]
            ).reshape(-1, 5),
        }

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Stand as when ``arrays`` were taken."""
        self._tables = arrays["voxel_tables"].astype(np.int32)
        self._pool = arrays["voxel_pool"].astype(np.int8)
        self._bricks = self._pool.shape[0]
        rows = arrays["voxel_submaps"].tolist()
        self.submaps = [Submap(int(key), Pose2(x, y, yaw), int(used)) for key, x, y, yaw, used in rows]
        self._uses = max((submap.used for submap in self.submaps), default=0)

    def _first(self, centre_m: float) -> int:
        """First row or column of the scratch box about a place in the submap, cut to the submap."""
        first = math.floor(centre_m / self.cell_m) + self._half - self._box // 2
        return min(max(first, 0), 2 * self._half - self._box)

    def _disc(self, at_m: tuple[float, float], radius_m: float) -> NDArray[np.bool_]:
        """Columns of the scratch box about a place in it."""
        across, along = self._off(at_m)
        return np.asarray(across**2 + along**2 <= radius_m**2)

    def _off(self, at_m: tuple[float, float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """How far the columns of the scratch box are from a place in it, along x and y, metres."""
        rows, cols = np.ogrid[: self._box, : self._box]
        return (cols + 0.5) * self.cell_m - at_m[0], (rows + 0.5) * self.cell_m - at_m[1]

    def _in_sight(self, cloud: LevelCloud, at_m: tuple[float, float], yaw_rad: float) -> NDArray[np.bool_]:
        """Columns of the scratch box with nothing in the band before or in them, seen from a place."""
        reach_m = self._box * self.cell_m
        scan = virtual_scan(cloud, self._heights.low_m, self._heights.high_m, reach_m)
        free_m = np.where(np.isnan(scan.ranges_m), 0.0, scan.ranges_m) - self.cell_m
        x, y = self._off(at_m)
        bearings = np.mod(np.arctan2(y, x) - yaw_rad + math.pi, 2.0 * math.pi)
        beams = np.minimum((bearings / (2.0 * math.pi) * len(free_m)).astype(np.int64), len(free_m) - 1)
        return np.asarray(np.hypot(x, y) < free_m[beams])

    def _know(self, columns: NDArray[np.bool_]) -> None:
        """Floor below these columns, nothing in the band but what the sweep struck."""
        band = self._scratch[columns]
        band[:, round(-self._bottom_m / self.cell_m)] = 2
        body = band[:, self._low : self._high]
        body[body == 0] = 1
        self._scratch[columns] = band
        self._touched |= columns

"""Puts furniture into a space so that one can still walk everywhere."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.worlds.plan import Box, Door, Piece, Space, rounded

__all__ = ["SIDES", "Furnisher"]

SIDES = ("south", "east", "north", "west")
_CELL_M = 0.05
_WALK_M = 0.3  # half the width of the ways that furniture leaves
_DOOR_DEPTH_M = 0.75
_TRIES = 24
_LEAST_SHARE = 0.35


class Furnisher:
    """One space: pieces go in one by one, and only where all doors stay joined by a way 0.6 m wide."""

    def __init__(self, space: Space, doors: Sequence[Door], rng: np.random.Generator) -> None:
        self.floor = space.floor
        self.rng = rng
        self.pieces: list[Piece] = []
        self._named: dict[str, int] = {}
        self._solid: list[Box] = []
        self._space = space
        reached = [(door, door.inside(self.floor, 0.35)) for door in doors]
        self._doors = [door for door, point in reached if point is not None]
        self._points = [point for _, point in reached if point is not None]
        self._open_cells = max(int(np.count_nonzero(self._walkable(()))), 1)

    @property
    def middle(self) -> tuple[float, float]:
        """Of the floor."""
        return ((self.floor.x0 + self.floor.x1) / 2, (self.floor.y0 + self.floor.y1) / 2)

    def free_sides(self) -> list[str]:
        """The sides, those without a door first, in random order otherwise."""
        sides = [SIDES[i] for i in self.rng.permutation(4)]
        return sorted(sides, key=lambda side: any(self._is_at(door, side) for door in self._doors))

    def against_wall(
        self,
        name: str,
        along_m: float,
        deep_m: float,
        height_m: float,
        sides: Sequence[str] = (),
        *,
        corner: bool = False,
        legs_m: float | None = None,
    ) -> tuple[Box, str] | None:
        """Stand a box against a wall, in a corner if asked for; where it stands and at which side."""
        for side in sides or self.free_sides():
            for attempt in range(_TRIES):
                ends = (0.0, 1.0) if self.rng.random() < 0.5 else (1.0, 0.0)
                share = ends[attempt % 2] if corner or attempt < 2 else float(self.rng.random())
                if not corner and attempt == 0:
                    share = float(self.rng.choice([0.5, share]))
                box = self.wall_box(side, along_m, deep_m, share)
                if box is not None and self.put(name, box, height_m, legs_m=legs_m):
                    return box, side
                if corner and attempt == 1:
                    break
        return None

    def wall_box(self, side: str, along_m: float, deep_m: float, share: float) -> Box | None:
        """A box along a wall, ``share`` of the way from its lower end; None if it is too long or too deep."""
        f = self.floor
        length, depth = (f.width, f.height) if side in ("south", "north") else (f.height, f.width)
        if along_m > length + 1e-9 or deep_m > depth + 1e-9:
            return None
        low = min(rounded(share * (length - along_m)), length - along_m)
        if side == "south":
            return Box(f.x0 + low, f.y0, f.x0 + low + along_m, f.y0 + deep_m)
        if side == "north":
            return Box(f.x0 + low, f.y1 - deep_m, f.x0 + low + along_m, f.y1)
        if side == "west":
            return Box(f.x0, f.y0 + low, f.x0 + deep_m, f.y0 + low + along_m)
        return Box(f.x1 - deep_m, f.y0 + low, f.x1, f.y0 + low + along_m)

    def put(
        self, name: str, box: Box, height_m: float, *, legs_m: float | None = None, gap_m: float = 0.0
    ) -> bool:
        """Put a box exactly there, if it may stand there."""
        return self._add(name, "box", (box.x0, box.y0, box.x1, box.y1), box, height_m, legs_m, gap_m)

    def put_round(self, name: str, x: float, y: float, radius_m: float, height_m: float) -> bool:
        """Put something round there, if it may stand there."""
        box = Box(x - radius_m, y - radius_m, x + radius_m, y + radius_m)
        return self._add(name, "circle", (x, y, radius_m), box, height_m, None, 0.0)

    def in_corner(self, name: str, radius_m: float, height_m: float) -> bool:
        """Stand something round into some corner."""
        f, off = self.floor, radius_m + 0.05
        corners = [(x, y) for x in (f.x0 + off, f.x1 - off) for y in (f.y0 + off, f.y1 - off)]
        order = self.rng.permutation(4).tolist()
        return any(self.put_round(name, corners[i][0], corners[i][1], radius_m, height_m) for i in order)

    def put_polygon(
        self, name: str, xy: Sequence[tuple[float, float]], parts: Sequence[Box], height_m: float
    ) -> bool:
        """Put a piece of several boxes there, given its outline, if all of them may stand there."""
        if not self._may_stand(parts, 0.0):
            return False
        self._take(name, "polygon", tuple(value for point in xy for value in point), parts, height_m, None)
        return True

    def widest(self) -> tuple[float, float]:
        """The place with the most room."""
        free = np.pad(self._free(self._solid), 1)
        distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
        row, col = np.unravel_index(int(np.argmax(distance)), distance.shape)
        x, y = self.floor.x0 + (float(col) + 0.5) * _CELL_M, self.floor.y0 + (float(row) + 0.5) * _CELL_M
        return (rounded(x), rounded(y))

    def _add(
        self,
        name: str,
        shape: str,
        numbers: tuple[float, ...],
        box: Box,
        height_m: float,
        legs_m: float | None,
        gap_m: float,
    ) -> bool:
        if not self._may_stand([box], gap_m):
            return False
        self._take(name, shape, numbers, [box], height_m, legs_m)
        return True

    def _take(
        self,
        name: str,
        shape: str,
        numbers: tuple[float, ...],
        parts: Sequence[Box],
        height_m: float,
        legs_m: float | None,
    ) -> None:
        self._named[name] = self._named.get(name, 0) + 1
        title = name if self._named[name] == 1 else f"{name} {self._named[name]}"
        self.pieces.append(Piece(f"{title} of {self._space.name}", shape, numbers, height_m, legs_m))
        self._solid += parts

    def _may_stand(self, parts: Sequence[Box], gap_m: float) -> bool:
        for box in parts:
            if not self.floor.holds(box) or any(box.grown(gap_m).meets(other) for other in self._solid):
                return False
            if any(box.meets(door.zone(_DOOR_DEPTH_M)) for door in self._doors):
                return False
        return self._leaves_ways([*self._solid, *parts])

    def _leaves_ways(self, solid: Sequence[Box]) -> bool:
        """All doors and nearly all of the walkable floor in one piece, and enough of it."""
        walkable = self._walkable(solid)
        count, labels = cv2.connectedComponents(walkable, connectivity=4)
        if count < 2:
            return False
        sizes = np.bincount(labels.ravel(), minlength=count)
        sizes[0] = 0
        main = int(np.argmax(sizes))
        at_doors = {int(labels[self._cell(point)]) for point in self._points}
        enough = sizes[main] >= max(_LEAST_SHARE * self._open_cells, 0.95 * sizes.sum())
        return at_doors <= {main} and bool(enough)

    def _walkable(self, solid: Sequence[Box]) -> NDArray[np.uint8]:
        free = np.pad(self._free(solid), 1)
        distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
        return np.asarray((distance - 0.5) * _CELL_M >= _WALK_M - 1e-6, dtype=np.uint8)

    def _free(self, solid: Sequence[Box]) -> NDArray[np.uint8]:
        rows, cols = (max(round(n / _CELL_M), 1) for n in (self.floor.height, self.floor.width))
        free = np.ones((rows, cols), dtype=np.uint8)
        for box in solid:
            low_x, high_x = (math.floor((box.x0 - self.floor.x0) / _CELL_M + 1e-6), box.x1 - self.floor.x0)
            low_y, high_y = (math.floor((box.y0 - self.floor.y0) / _CELL_M + 1e-6), box.y1 - self.floor.y0)
            end_row, end_col = (math.ceil(high / _CELL_M - 1e-6) for high in (high_y, high_x))
            free[max(low_y, 0) : end_row, max(low_x, 0) : end_col] = 0
        return free

    def _cell(self, point: tuple[float, float]) -> tuple[int, int]:
        return (int((point[1] - self.floor.y0) / _CELL_M), int((point[0] - self.floor.x0) / _CELL_M))

    def _is_at(self, door: Door, side: str) -> bool:
        if door.upright != (side in ("east", "west")):
            return False
        edge = {"west": self.floor.x0, "east": self.floor.x1, "south": self.floor.y0, "north": self.floor.y1}
        return abs((door.x if door.upright else door.y) - edge[side]) < 0.2

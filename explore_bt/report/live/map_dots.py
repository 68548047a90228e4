"""A map in braille dots: 2 × 4 to a character, walls as dots, known floor as a shade behind them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.text import Text

from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

__all__ = ["MapDots", "RobotMark"]

_BLANK = 0x2800
_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.int64)
_ARROWS = "→↗↑↖←↙↓↘"
_OUTSIDE, _FLOOR, _TRAIL = "bright_white", "bright_white on grey23", "{} on grey23"


@dataclass(frozen=True, slots=True, eq=False)
class RobotMark:
    """A robot on the map: where it is, (N, 2) float64 where it was, and where it heads."""

    pose: Pose2
    trail: NDArray[np.float64]
    goal: Pose2 | None
    colour: str


class MapDots:
    """Draws maps into a fixed number of characters; a map that has not changed is not drawn anew."""

    def __init__(self, columns: int, rows: int) -> None:
        self._columns, self._rows = columns, rows
        self._grid: OccupancyGrid | None = None
        self._codes = np.zeros((rows, columns), dtype=np.int64)
        self._is_floor = np.zeros((rows, columns), dtype=np.bool_)
        self._metres_per_dot = 1.0
        self._corner = (0.0, 0.0)

    def lines(self, grid: OccupancyGrid, robots: Sequence[RobotMark]) -> list[Text]:
        """As many lines as there are rows, each as long as there are columns."""
        if grid is not self._grid:
            self._grid = grid
            self._draw_map(grid)
        codes, styles = self._codes.copy(), np.where(self._is_floor, 1, 0)
        names = [_OUTSIDE, _FLOOR]
        letters: dict[tuple[int, int], str] = {}
        for robot in robots:
            names += [_TRAIL.format(robot.colour), f"bold {robot.colour} on grey23"]
            trail, mark = len(names) - 2, len(names) - 1
            dots = self._dots(robot.trail)
            codes |= _codes(dots)
            styles[_blocks(dots).any(axis=(1, 3))] = trail
            for pose, letter in ((robot.goal, "◎"), (robot.pose, _arrow(robot.pose.yaw_rad))):
                place = self._character(pose) if pose is not None else None
                if place is not None:
                    letters[place] = letter
                    styles[place] = mark
        return [self._line(row, codes[row], styles[row], names, letters) for row in range(self._rows)]

    def _draw_map(self, grid: OccupancyGrid) -> None:
        known = grid.cells != UNKNOWN
        rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
        if not len(rows):
            self._codes[:], self._is_floor[:] = 0, False
            return
        size = grid.resolution_m
        width_m, height_m = (float(found[-1] - found[0] + 1) * size for found in (cols, rows))
        dots_x, dots_y = self._columns * 2, self._rows * 4
        self._metres_per_dot = max(width_m / dots_x, height_m / dots_y, 1e-6)
        low_x, low_y = grid.origin_xy[0] + float(cols[0]) * size, grid.origin_xy[1] + float(rows[0]) * size
        # the map stands in the middle of its field
        self._corner = (
            low_x - 0.5 * (dots_x * self._metres_per_dot - width_m),
            low_y - 0.5 * (dots_y * self._metres_per_dot - height_m),
        )
        self._codes = _codes(self._dots(grid.centers_of(np.argwhere(grid.cells == OCCUPIED))))
        step = max(1, int(self._metres_per_dot / size))  # no finer than the dots
        free = np.argwhere(grid.cells[::step, ::step] == FREE) * step
        floor = _blocks(self._dots(grid.centers_of(free)))
        self._is_floor = floor.sum(axis=(1, 3)) >= 2

    def _dots(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(4 · rows, 2 · columns) bool, top row first: dots that hold a point."""
        dots = np.zeros((self._rows * 4, self._columns * 2), dtype=np.bool_)
        with np.errstate(invalid="ignore"):
            place = np.floor((points - np.asarray(self._corner)) / self._metres_per_dot)
            x, y = place[:, 0], len(dots) - 1 - place[:, 1]
            inside = (x >= 0) & (x < dots.shape[1]) & (y >= 0) & (y < len(dots))
        dots[y[inside].astype(np.int64), x[inside].astype(np.int64)] = True
        return dots

    def _character(self, pose: Pose2) -> tuple[int, int] | None:
        if not math.isfinite(pose.x + pose.y):
            return None
        column = math.floor((pose.x - self._corner[0]) / self._metres_per_dot / 2)
        row = self._rows - 1 - math.floor((pose.y - self._corner[1]) / self._metres_per_dot / 4)
        return (row, column) if 0 <= row < self._rows and 0 <= column < self._columns else None

    def _line(
        self,
        row: int,
        codes: NDArray[np.int64],
        styles: NDArray[np.int64],
        names: list[str],
        letters: dict[tuple[int, int], str],
    ) -> Text:
        characters = [chr(_BLANK + code) if code else " " for code in codes.tolist()]
        for (at_row, column), letter in letters.items():
            if at_row == row:
                characters[column] = letter
        line = Text(no_wrap=True)
        begin = 0
        for end in [*(np.flatnonzero(np.diff(styles)) + 1).tolist(), len(characters)]:
            line.append("".join(characters[begin:end]), names[int(styles[begin])])
            begin = end
        return line


def _blocks(dots: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return dots.reshape(dots.shape[0] // 4, 4, dots.shape[1] // 2, 2)


def _codes(dots: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.einsum("iajb,ab->ij", _blocks(dots).astype(np.int64), _BITS)


def _arrow(yaw_rad: float) -> str:
    return _ARROWS[round(yaw_rad / (math.pi / 4)) % 8] if math.isfinite(yaw_rad) else "?"

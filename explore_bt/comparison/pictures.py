"""Maps as pictures of one scale and one frame, so that they can be held against each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.report import data_uri, robot_colour
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

__all__ = ["Extent", "difference_svg", "extent_of", "map_svg"]

_UNKNOWN, _FREE, _WALL = (0, 0, 0, 0), (255, 255, 255, 255), (66, 53, 43, 255)
_ONLY_FIRST, _ONLY_SECOND, _DISAGREE = (237, 111, 47, 255), (13, 115, 217, 255), (38, 61, 215, 255)
_BOTH_FREE, _BOTH_WALL = (245, 242, 240, 255), (150, 140, 130, 255)
"""Blue, green, red, alpha."""


@dataclass(frozen=True, slots=True)
class Extent:
    """A box in the ``map`` frame, metres."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def view_box(self) -> str:
        """For an SVG whose y points down."""
        return f"{self.x0:.3f} {-self.y1:.3f} {self.x1 - self.x0:.3f} {self.y1 - self.y0:.3f}"


def extent_of(grids: Sequence[OccupancyGrid]) -> Extent:
    """The box around all of them."""
    boxes = np.array([_box(grid) for grid in grids])
    return Extent(*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())


def map_svg(grid: OccupancyGrid, ways: Mapping[str, NDArray[np.float64]], extent: Extent) -> str:
    """A map with the ways driven in it, and where each began."""
    pixels = np.zeros((*grid.shape, 4), dtype=np.uint8)
    pixels[grid.cells == FREE], pixels[grid.cells == OCCUPIED] = _FREE, _WALL
    drawn = "".join(_way(way, robot_colour(index)) for index, way in enumerate(ways.values()))
    return _svg(extent, _image(pixels, grid) + drawn)


def difference_svg(one: OccupancyGrid, other: OccupancyGrid, extent: Extent) -> str:
    """What only one of two maps knows, and where one says free and the other occupied."""
    size = one.resolution_m
    shape = (round((extent.y1 - extent.y0) / size) + 1, round((extent.x1 - extent.x0) / size) + 1)
    frame = OccupancyGrid(np.full(shape, UNKNOWN, dtype=np.int8), size, (extent.x0, extent.y0))
    first, second = (_on(frame, grid) for grid in (one, other))
    pixels = np.zeros((*shape, 4), dtype=np.uint8)
    pixels[(first == FREE) & (second == FREE)] = _BOTH_FREE
    pixels[(first == OCCUPIED) & (second == OCCUPIED)] = _BOTH_WALL
    pixels[(first != UNKNOWN) & (second == UNKNOWN)] = _ONLY_FIRST
    pixels[(first == UNKNOWN) & (second != UNKNOWN)] = _ONLY_SECOND
    pixels[_disagree(first, second)] = _DISAGREE
    return _svg(extent, _image(pixels, frame))


def _disagree(first: NDArray[np.int8], second: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Occupied in one and free in the other, with no wall of the other beside it: a cell is no difference."""
    found = np.zeros(first.shape, dtype=np.bool_)
    for one, other in ((first, second), (second, first)):
        near_wall = cv2.dilate((other == OCCUPIED).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        found |= (one == OCCUPIED) & (other == FREE) & ~near_wall
    return found


def _on(frame: OccupancyGrid, grid: OccupancyGrid) -> NDArray[np.int8]:
    """The cells of a grid laid onto another's."""
    cells = frame.cells.copy()
    at = grid.cells_of(frame.centers_of(np.argwhere(np.ones(frame.shape, dtype=np.bool_))))
    inside = ((at >= 0) & (at < np.array(grid.shape))).all(axis=1)
    cells.ravel()[inside] = grid.cells[at[inside, 0], at[inside, 1]]
    return cells


def _box(grid: OccupancyGrid) -> tuple[float, float, float, float]:
    (x, y), (rows, cols), size = grid.origin_xy, grid.shape, grid.resolution_m
    return (x, y, x + cols * size, y + rows * size)


def _image(pixels: NDArray[np.uint8], grid: OccupancyGrid) -> str:
    _, encoded = cv2.imencode(".png", pixels[::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])
    x0, y0, x1, y1 = _box(grid)
    return (
        f'<image href="{data_uri(bytes(encoded.tobytes()))}" x="{x0:.3f}" y="{-y1:.3f}" '
        f'width="{x1 - x0:.3f}" height="{y1 - y0:.3f}" preserveAspectRatio="none"/>'
    )


def _way(way: NDArray[np.float64], colour: str) -> str:
    points = " ".join(f"{x:.2f},{-y:.2f}" for x, y in way.tolist())
    x, y = way[0].tolist()
    start = f'<circle cx="{x:.2f}" cy="{-y:.2f}" r="0.12" fill="{colour}"/>'
    return f'<polyline points="{points}" stroke="{colour}"/>{start}'


def _svg(extent: Extent, content: str) -> str:
    return f'<svg class="sheet" role="img" viewBox="{extent.view_box}">{content}</svg>'

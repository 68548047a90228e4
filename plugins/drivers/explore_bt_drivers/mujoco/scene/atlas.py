"""One picture that holds the texture of every patch, no two alike."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.surface import Surface

__all__ = ["Atlas"]

_TEXEL_M = 0.01
_MOST_TEXELS = 8_000_000
_LARGEST_SIDE = 8192
_GAP = 2
_GRAINS = ((0.04, 0.24), (0.13, 0.24), (0.50, 0.16))
"""Side of a tile in metres and its share of the brightness: corners for ORB from near and from afar."""
_PICTURES_PER_M2 = 1.5
_PICTURE_M = (0.06, 0.45)
_LEAST_SIDE_M = 0.5
_MOST_PICTURES = 4000


class Atlas:
    """Packs the patches of a surface into a picture and paints them.

    Features of repeated textures match where they should not, so every patch has paint of its own: tiles of
    three sizes over its tint, and coloured rectangles where it is wide enough for pictures on the wall.

    Attributes:
        pixels: (rows, cols, 3) uint8 RGB.
        uv: (V, 2) float64, 0 to 1: of every vertex of the surface; v is 0 in the first row.
    """

    def __init__(self, surface: Surface, rng: np.random.Generator) -> None:
        self._texel_m = _texel_m(surface.sizes)
        self._cells = np.ceil(surface.sizes / self._texel_m).astype(np.int64) + _GAP
        square = math.sqrt(float(self._cells.prod(axis=1).sum()))
        width = max(2 ** math.ceil(math.log2(square)), int(self._cells[:, 0].max()))
        self._corners, height = _packed(self._cells, width)
        self.pixels = self._painted(surface, (height, width), rng)
        places = self._corners[surface.patches] + _GAP / 2 + surface.local / self._texel_m
        self.uv = places / (width, height)

    def _painted(
        self, surface: Surface, shape: tuple[int, int], rng: np.random.Generator
    ) -> NDArray[np.uint8]:
        tint = np.zeros((*shape, 3), dtype=np.uint8)
        colours = np.round(surface.tints * 255.0).astype(np.uint8)
        for (x, y), (w, h), colour in zip(self._corners.tolist(), self._cells.tolist(), colours, strict=True):
            tint[y : y + h, x : x + w] = colour
        self._hang_pictures(tint, surface, rng)
        light = _noise(shape, self._texel_m, rng)
        return np.asarray(cv2.multiply(tint, cv2.merge([light] * 3), scale=1.3 / 255.0))

    def _hang_pictures(self, pixels: NDArray[np.uint8], surface: Surface, rng: np.random.Generator) -> None:
        """Coloured rectangles on those walls that are wide and high enough, in proportion to their area."""
        heights = np.full((len(surface.sizes), 2), -np.inf)
        np.maximum.at(heights[:, 0], surface.patches, surface.vertices[:, 2])
        np.maximum.at(heights[:, 1], surface.patches, -surface.vertices[:, 2])
        is_upright = heights.sum(axis=1) > 0.9 * surface.sizes[:, 1]
        wide = np.flatnonzero((surface.sizes.min(axis=1) >= _LEAST_SIDE_M) & is_upright)
        areas = surface.sizes[wide].prod(axis=1)
        if len(wide) == 0:
            return
        count = min(math.ceil(areas.sum() * _PICTURES_PER_M2), _MOST_PICTURES)
        chosen = wide[rng.choice(len(wide), count, p=areas / areas.sum())]
        sizes = np.maximum(rng.uniform(*_PICTURE_M, (count, 2)) / self._texel_m, 1.0).astype(np.int64)
        room = self._cells[chosen] - sizes
        corners = self._corners[chosen] + (rng.random((count, 2)) * np.maximum(room, 0)).astype(np.int64)
        colours = rng.integers(20, 256, (count, 3), dtype=np.uint8)
        for (x, y), (w, h), colour in zip(corners.tolist(), sizes.tolist(), colours, strict=True):
            part = pixels[y : y + h, x : x + w]
            part[:] = (part // 3) + (colour // 3 * 2)


def _texel_m(sizes: NDArray[np.float64]) -> float:
    """As fine as the largest picture allows."""
    by_area = math.sqrt(float(sizes.prod(axis=1).sum()) / _MOST_TEXELS)
    by_side = float(sizes.max()) / (_LARGEST_SIDE - 2 * _GAP)
    return max(_TEXEL_M, by_area, by_side)


def _packed(cells: NDArray[np.int64], width: int) -> tuple[NDArray[np.int64], int]:
    """(P, 2) corners of rectangles on shelves of that width, highest first, and the height of all of them."""
    places: list[tuple[int, int]] = [(0, 0)] * len(cells)
    x = y = shelf = 0
    sizes = cells.tolist()
    for index in np.argsort(-cells[:, 1], kind="stable").tolist():
        w, h = sizes[index]
        if x + w > width:
            x, y, shelf = 0, y + shelf, 0
        places[index] = (x, y)
        x, shelf = x + w, max(shelf, h)
    return np.array(places, dtype=np.int64), y + shelf


def _noise(shape: tuple[int, int], texel_m: float, rng: np.random.Generator) -> NDArray[np.uint8]:
    """(rows, cols) uint8 brightness, darkened from 255 by tiles of every grain."""
    light = np.full(shape, 255, dtype=np.uint8)
    for grain_m, share in _GRAINS:
        grain = max(grain_m / texel_m, 1.0)
        rows, cols = (math.ceil(side / grain) + 1 for side in shape)
        tiles = rng.integers(0, round(255 * share), (rows, cols), dtype=np.uint8)
        light = cv2.subtract(light, cv2.resize(tiles, (shape[1], shape[0]), interpolation=cv2.INTER_NEAREST))
    return light

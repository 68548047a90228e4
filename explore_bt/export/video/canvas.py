"""A picture to draw on: lines by OpenCV, words by Pillow, which knows more than ASCII."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

__all__ = ["Canvas", "rgb"]

Colour = tuple[int, int, int]
_SHIFT = 4  # of OpenCV's fixed-point coordinates: a sixteenth of a pixel


@lru_cache
def rgb(colour: str) -> Colour:
    """``#rrggbb`` as red, green and blue."""
    return (int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16))


@lru_cache
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    import matplotlib  # its fonts come with it, so that every machine draws the same

    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name), size)


class Canvas:
    """RGB pixels; coordinates are pixels from the upper left corner, x to the right.

    Attributes:
        pixels: (height, width, 3) uint8.
    """

    def __init__(self, width: int, height: int, colour: Colour) -> None:
        self.pixels = np.full((height, width, 3), colour, dtype=np.uint8)
        self._words: list[tuple[tuple[float, float], str, Colour, int, bool]] = []

    def fill(self, box: tuple[int, int, int, int], colour: Colour) -> None:
        """A rectangle: x, y, width, height."""
        x, y, width, height = box
        self.pixels[max(y, 0) : y + height, max(x, 0) : x + width] = colour

    def line(self, points: NDArray[np.float64], colour: Colour, width: int = 1) -> None:
        """An open line through (N, 2) points."""
        if len(points) > 1:
            cv2.polylines(self.pixels, [_fixed(points)], False, colour, width, cv2.LINE_AA, _SHIFT)

    def area(self, points: NDArray[np.float64], colour: Colour, opacity: float) -> None:
        """A filled convex area, which shows what lies below."""
        if not np.isfinite(points).all():
            return
        low = np.floor(points.min(axis=0)).astype(int).clip(0)
        high = np.ceil(points.max(axis=0)).astype(int) + 1
        part = self.pixels[low[1] : high[1], low[0] : high[0]]
        if part.size == 0:
            return
        above = part.copy()
        cv2.fillPoly(above, [_fixed(points - low)], colour, cv2.LINE_AA, _SHIFT)
        part[:] = cv2.addWeighted(above, opacity, part, 1.0 - opacity, 0.0)

    def dot(self, place: Sequence[float], radius: float, colour: Colour, width: int = -1) -> None:
        """A disc, or a ring of a width."""
        if not np.isfinite(place).all():
            return
        x, y = _fixed(np.asarray(place, dtype=np.float64)).tolist()
        cv2.circle(self.pixels, (x, y), round(radius * 2**_SHIFT), colour, width, cv2.LINE_AA, _SHIFT)

    def dots(self, points: NDArray[np.float64], colour: Colour) -> None:
        """Two by two pixels at each of (N, 2) points."""
        height, width, _ = self.pixels.shape
        x, y = np.floor(points - 0.5).astype(int).T
        inside = (x >= 0) & (x < width - 1) & (y >= 0) & (y < height - 1)
        for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
            self.pixels[y[inside] + down, x[inside] + right] = colour

    def text(
        self, place: tuple[float, float], words: str, colour: Colour, size: int = 13, *, bold: bool = False
    ) -> None:
        """Words whose upper left corner is at a place; they lie above all else."""
        self._words.append((place, words, colour, size, bold))

    @staticmethod
    def width_of(words: str, size: int = 13, *, bold: bool = False) -> float:
        """How wide the words are, pixels."""
        return _font(size, bold).getlength(words)

    def cut_to(self, words: str, width: float, size: int = 13) -> str:
        """As much of the words as fits, an ellipsis at the end if not all."""
        font = _font(size, False)
        if font.getlength(words) <= width:
            return words
        count = len(words)
        while count > 0 and font.getlength(words[:count] + "…") > width:
            count -= 1
        return words[:count] + "…"

    def finished(self) -> NDArray[np.uint8]:
        """The pixels, words included."""
        image = Image.fromarray(self.pixels)
        pen = ImageDraw.Draw(image)
        for place, words, colour, size, bold in self._words:
            pen.text(place, words, fill=colour, font=_font(size, bold))
        return np.asarray(image)


def _fixed(points: NDArray[np.float64]) -> NDArray[np.int32]:
    """For OpenCV a pixel's middle is at a whole number; what is far outside is brought near."""
    return np.round((points.clip(-1e4, 1e4) - 0.5) * 2**_SHIFT).astype(np.int32)

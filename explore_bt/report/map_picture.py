"""The map as small grey pictures, to be put into a page and coloured there."""

from __future__ import annotations

import base64

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import OccupancyGrid

__all__ = ["cells_png", "data_uri", "first_seen_png"]

UNKNOWN_GREY, OCCUPIED_GREY, FREE_GREY = 0, 128, 255


def cells_png(grid: OccupancyGrid) -> bytes:
    """Greys 0 unknown, 128 occupied, 255 free; the top row is the highest y."""
    greys = np.full(grid.shape, UNKNOWN_GREY, dtype=np.uint8)
    greys[grid.occupied] = OCCUPIED_GREY
    greys[grid.free] = FREE_GREY
    return _png(greys)


def first_seen_png(stamps_s: NDArray[np.float32], end_s: float) -> bytes:
    """Grey 0–254 for the share of the mission after which a cell was known, 255 for never."""
    share = np.clip(stamps_s / max(end_s, 1e-6), 0.0, 1.0)
    return _png(np.where(np.isfinite(stamps_s), np.round(share * 254.0), 255.0).astype(np.uint8))


def data_uri(png: bytes) -> str:
    """The picture as an address that needs no file."""
    return "data:image/png;base64," + base64.b64encode(png).decode()


def _png(greys: NDArray[np.uint8]) -> bytes:
    _, encoded = cv2.imencode(".png", greys[::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])
    return bytes(encoded.tobytes())

"""Map files of ROS map_server: a picture and a YAML file that says what its greys mean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import yaml
from numpy.typing import NDArray

from explore_bt.errors import WorldError
from explore_bt.files import write_whole
from explore_bt.maps.marked_yaml import MarkedFile
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from explore_bt.units import LENGTH, Dimension

__all__ = ["read_map", "write_map"]

_NOUN = "a map_server map"
_KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_SHARE = Dimension("share", "of 1", (), "0.65")
_FREE_GREY, _OCCUPIED_GREY, _UNKNOWN_GREY = 254, 0, 205


@dataclass(frozen=True, slots=True)
class _Header:
    image: Path
    resolution_m: float
    origin_xy: tuple[float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float


def read_map(path: Path) -> OccupancyGrid:
    """Read a map, as ``map_server`` in mode ``trinary`` does.

    Args:
        path: the YAML file; the picture (PGM, PNG, ...) is looked up beside it.

    Returns:
        The grid in the ``map`` frame, row 0 at the lowest y.

    Raises:
        WorldError: with every fault of the YAML file, or what is wrong with the picture.
    """
    file = MarkedFile(path)
    header = _read_header(file)
    darkness = _darkness(header.image, path, header.negate)
    cells = np.full(darkness.shape, UNKNOWN, dtype=np.int8)
    cells[darkness > header.occupied_thresh] = OCCUPIED
    cells[darkness < header.free_thresh] = FREE
    return OccupancyGrid(np.ascontiguousarray(cells[::-1]), header.resolution_m, header.origin_xy)


def write_map(grid: OccupancyGrid, folder: Path, stem: str = "map") -> list[Path]:
    """Write ``stem.pgm`` and ``stem.yaml`` with the greys and thresholds of ``map_saver``.

    Returns:
        The two files, the picture first; ``read_map`` gives the same cells back.

    Raises:
        OSError: the folder cannot be written.
    """
    greys = np.full(grid.shape, _UNKNOWN_GREY, dtype=np.uint8)
    greys[grid.free] = _FREE_GREY
    greys[grid.occupied] = _OCCUPIED_GREY
    rows, cols = grid.shape
    head = f"P5\n# CREATOR: explore-bt {grid.resolution_m:.3f} m/pix\n{cols} {rows}\n255\n"
    picture = write_whole(folder / f"{stem}.pgm", head.encode() + greys[::-1].tobytes())
    x, y = (float(value) for value in grid.origin_xy)
    text = (
        f"image: {picture.name}\n"
        "mode: trinary\n"
        f"resolution: {float(grid.resolution_m)!r}\n"
        f"origin: [{x!r}, {y!r}, 0.0]\n"
        "negate: 0\n"
        "occupied_thresh: 0.65\n"
        "free_thresh: 0.196\n"
    )
    return [picture, write_whole(folder / f"{stem}.yaml", text)]


def _read_header(file: MarkedFile) -> _Header:
    root = file.root(_NOUN)
    # other tools add keys of their own, so strangers are let through
    keys = file.fields(root, _NOUN, required=_KEYS, optional=("mode",), strict=False)
    image = file.text(keys.get("image"), "image")
    resolution = file.quantity(keys.get("resolution"), LENGTH, "resolution")
    if resolution is not None and resolution <= 0.0:
        file.fault(keys["resolution"], f"resolution is {resolution:g} m; expected metres per cell above 0")
    origin = file.pose(keys.get("origin"))
    if origin is not None and origin[2] != 0.0:
        file.fault(
            keys["origin"], f"the map is turned by {origin[2]:g} rad; only yaw 0 is read: turn the picture"
        )
    occupied = file.quantity(keys.get("occupied_thresh"), _SHARE, "occupied_thresh", low=0.0, high=1.0)
    free = file.quantity(keys.get("free_thresh"), _SHARE, "free_thresh", low=0.0, high=1.0)
    if occupied is not None and free is not None and free > occupied:
        file.fault(keys["free_thresh"], f"free_thresh {free:g} lies above occupied_thresh {occupied:g}")
    negate = _negate(file, keys.get("negate"))
    _check_mode(file, keys.get("mode"))
    file.raise_faults()
    assert image is not None
    assert resolution is not None
    assert origin is not None
    assert occupied is not None
    assert free is not None
    return _Header(file.path.parent / image, resolution, (origin[0], origin[1]), negate, occupied, free)


def _negate(file: MarkedFile, node: yaml.Node | None) -> bool:
    word = None if node is None else str(node.value).lower()
    if word not in (None, "0", "1", "true", "false") and node is not None:
        file.fault(node, f"negate is {node.value}; expected 0 or 1")
    return word in ("1", "true")


def _check_mode(file: MarkedFile, node: yaml.Node | None) -> None:
    if node is not None and node.value != "trinary":
        file.fault(node, f"mode is {node.value}; only trinary maps are read: save it with mode trinary")


def _darkness(image: Path, source: Path, negate: bool) -> NDArray[np.float64]:
    """(rows, cols) float64 in [0, 1]: 1 is an obstacle for sure. Row 0 is the top of the picture."""
    pixels = _pixels(image, source)
    # map_server averages all channels, opacity among them, in mode trinary
    grey = pixels.mean(axis=2) if pixels.ndim == 3 else pixels.astype(np.float64)
    share = grey / np.iinfo(pixels.dtype).max
    return share if negate else 1.0 - share


def _pixels(image: Path, source: Path) -> NDArray[np.unsignedinteger]:
    try:
        data = image.read_bytes()
    except FileNotFoundError:
        raise WorldError(
            f"{source}: its image {image} does not exist; put it there or correct the line 'image:'"
        ) from None
    except OSError as error:
        raise WorldError(f"{source}: its image {image} cannot be read ({error.strerror})") from None
    pixels = _decode(data)
    if pixels is None or math.prod(pixels.shape) == 0 or pixels.dtype.kind != "u":
        raise WorldError(
            f"{image}: is not a picture that can be read ({len(data)} bytes); expected PGM or PNG in 8 or "
            "16 bit: export the map again"
        )
    return pixels


def _decode(data: bytes) -> NDArray[np.unsignedinteger] | None:
    if not data:
        return None
    told = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(
        cv2.utils.logging.LOG_LEVEL_SILENT
    )  # the refusal says it once, in our words
    try:
        return cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        return None
    finally:
        cv2.utils.logging.setLogLevel(told)

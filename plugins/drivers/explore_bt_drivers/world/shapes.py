"""Furniture of a world file: boxes, polygons and circles."""

from __future__ import annotations

import numpy as np
import yaml
from numpy.typing import NDArray

from explore_bt.maps import MarkedFile
from explore_bt.units import ANGLE, LENGTH
from explore_bt_drivers.world.materials import read_material
from explore_bt_drivers.world.piece import Piece
from explore_bt_drivers.world.solid import (
    Material,
    Solid,
    box_corners,
    circle_corners,
    crossing_edges,
    signed_area,
)

__all__ = ["SHAPES", "read_furniture"]

SHAPES = ("box", "polygon", "circle")
_EXTRAS = ("turn", "legs", "top", "height", "underside", "material", "moved")
_TOP_M = 0.04
_SMALLEST_AREA_M2 = 1e-6


def read_furniture(
    file: MarkedFile, node: yaml.Node, default_height_m: float
) -> tuple[Piece, yaml.Node | None]:
    """One entry of ``furniture``: ``{name, box | polygon | circle, turn, height, material, moved, ...}``.

    With ``legs`` only four square legs of that width stand on the floor, one in each corner of the box, and
    carry a plate as thick as ``top``; with ``underside`` nothing does: it hangs on the wall.

    Returns:
        The piece as drawn, and the value of ``moved``, which only makes sense once the bounds are known.
    """
    keys = file.fields(node, "furniture", required=("name",), optional=(*SHAPES, *_EXTRAS))
    name = file.text(keys.get("name"), "name")
    height = file.quantity(keys.get("height"), LENGTH, "height", low=0.01)
    turn = file.quantity(keys.get("turn"), ANGLE, "turn")
    legs = file.quantity(keys.get("legs"), LENGTH, "legs", low=0.005)
    material = read_material(file, keys.get("material"))
    shapes = [key for key in SHAPES if key in keys]
    if keys and len(shapes) != 1:
        found = " and ".join(shapes) or "no shape"
        file.fault(node, f"furniture has {found}; expected one of {', '.join(SHAPES)}")
        return Piece(""), None
    if not shapes or name is None:
        return Piece(""), None
    for key in ("turn", "legs"):
        if key in keys and shapes[0] != "box":
            file.fault(keys[key], f"{key} goes with a box, not with a {shapes[0]}")
    before = file.fault_count
    heights = _read_heights(file, keys, name, height or default_height_m)
    whole = _footprints(file, keys[shapes[0]], shapes[0], turn or 0.0, None)
    feet = _footprints(file, keys[shapes[0]], shapes[0], turn or 0.0, legs) if whole and legs else []
    if file.fault_count > before:
        return Piece(name), keys.get("moved")
    return _piece(name, whole, feet, heights, material), keys.get("moved")


def _read_heights(
    file: MarkedFile, keys: dict[str, yaml.Node], name: str, height_m: float
) -> tuple[float, float]:
    """Where its topmost part begins and ends: at the floor, unless something carries it."""
    if "top" in keys and "legs" not in keys:
        file.fault(keys["top"], "top is the thickness of a plate on legs; give legs too, or leave it out")
    if "underside" in keys and "legs" in keys:
        file.fault(keys["underside"], "furniture has legs or an underside, not both; leave one out")
        return (0.0, height_m)
    top_m = file.quantity(keys.get("top"), LENGTH, "top", low=0.001) or _TOP_M
    low_m = file.quantity(keys.get("underside"), LENGTH, "underside", low=0.01) or 0.0
    if low_m >= height_m:
        wrong = f"the underside of {name} is at {low_m:g} m, its height {height_m:g} m"
        file.fault(keys["underside"], f"{wrong}; expected an underside below it: give a height")
    if "legs" in keys:
        low_m = height_m - top_m
        if low_m <= 0.0:
            wrong = f"the top of {name} is {top_m:g} m thick, its height {height_m:g} m"
            file.fault(keys.get("top", keys["legs"]), f"{wrong}; that leaves no legs: make one of them fit")
    return (low_m, height_m)


def _piece(
    name: str,
    whole: list[NDArray[np.float64]],
    feet: list[NDArray[np.float64]],
    heights: tuple[float, float],
    material: Material,
) -> Piece:
    low_m, high_m = heights
    main = tuple(Solid(name, corners, high_m, material, low_m) for corners in whole)
    if low_m == 0.0:
        return Piece(name, main)
    # legs are drawn up to the height of the piece, so that a planar robot's map has them as they were
    return Piece(name, tuple(Solid(name, corners, high_m) for corners in feet), main)


def _footprints(
    file: MarkedFile, node: yaml.Node, shape: str, turn_rad: float, legs_m: float | None
) -> list[NDArray[np.float64]]:
    if shape == "polygon":
        return _polygon(file, node)
    if shape == "circle":
        circle = file.lengths(node, "x y radius")
        if circle is not None and circle[2] <= 0.0:
            file.fault(node, f"the radius is {circle[2]:g} m; expected more than 0")
            return []
        return [] if circle is None else [circle_corners(circle[0], circle[1], circle[2])]
    box = file.lengths(node, "x0 y0 x1 y1")
    if box is None:
        return []
    x0, x1, y0, y1 = min(box[0], box[2]), max(box[0], box[2]), min(box[1], box[3]), max(box[1], box[3])
    if (x1 - x0) * (y1 - y0) < _SMALLEST_AREA_M2:
        file.fault(node, f"the box is {x1 - x0:g} m by {y1 - y0:g} m; its two corners must differ in x and y")
        return []
    if legs_m is None:
        return [box_corners(x0, y0, x1, y1, turn_rad)]
    if 2 * legs_m > min(x1 - x0, y1 - y0):
        file.fault(node, f"legs of {legs_m:g} m do not fit twice into {x1 - x0:g} m by {y1 - y0:g} m")
        return []
    return _four_legs((x0, y0, x1, y1), turn_rad, legs_m)


def _four_legs(
    box: tuple[float, float, float, float], turn_rad: float, width_m: float
) -> list[NDArray[np.float64]]:
    x0, y0, x1, y1 = box
    inset = width_m / 2
    centres = box_corners(x0 + inset, y0 + inset, x1 - inset, y1 - inset, turn_rad)
    return [box_corners(x - inset, y - inset, x + inset, y + inset, turn_rad) for x, y in centres]


def _polygon(file: MarkedFile, node: yaml.Node) -> list[NDArray[np.float64]]:
    before = file.fault_count
    points = [file.lengths(item, "x y") for item in file.items(node, "polygon")]
    if file.fault_count > before:
        return []
    corners = np.array([point for point in points if point is not None], dtype=np.float64).reshape(-1, 2)
    if len(corners) < 3:
        file.fault(node, f"the polygon has {len(corners)} corners; expected 3 or more")
        return []
    crossing = crossing_edges(corners)
    if crossing is not None:
        one, other = crossing
        file.fault(node, f"edges {one} and {other} of the polygon cross; list its corners in order round it")
        return []
    area = signed_area(corners)
    if abs(area) < _SMALLEST_AREA_M2:
        file.fault(node, "the polygon has no area; its corners lie in one line")
        return []
    return [corners if area > 0.0 else corners[::-1].copy()]

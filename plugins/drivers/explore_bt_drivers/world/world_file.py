"""Worlds drawn in YAML, ``format: explore-bt-world/1``::

    format: explore-bt-world/1
    name: two rooms
    start: [1.0 m, 1.0 m, 90 deg]                      # optional
    wall: {thickness: 10 cm, height: 2.5 m}            # optional, these are the defaults
    rooms:                                             # walls along the edges of two opposite corners
      - {name: hall, box: [0, 0, 4, 3]}
      - {name: study, box: [4, 0, 7, 3]}
    walls:                                             # any other walls, along their centre lines
      - {name: screen, path: [[1, 3], [1, 2], [2, 2]], material: glass}  # or mirror; matt by default
    doors:                                             # openings, centred on a point of a wall
      - {name: study door, at: [4, 1.5], width: 0.9 m, shut: [[20 s, 60 s]], sill: 15 mm}
    furniture:                                         # two corners, or a polygon, or x, y, radius
      - {name: desk, box: [5.5, 2.2, 6.9, 2.9], legs: 5 cm, top: 3 cm, height: 75 cm}
      - {name: shelf, box: [4.1, 2.7, 5.0, 2.95], underside: 1.4 m, height: 1.7 m}
      - {name: plant, circle: [0.4, 2.6, 0.2], moved: [{at: 60 s, to: [3.5, 2.6]}]}
    ramps:                                             # up along x of the box, level, and down again
      - {name: cable bridge, box: [2, 0, 3, 3], turn: 0 deg, slope: 2 deg, level: 20 cm}
    people:                                            # there and back again for ever
      - {name: ada, route: [[0.6, 0.6], [3.4, 0.6], [3.4, 1.5], [6.5, 1.5]], speed: 1.2 m/s}

A planar robot knows no heights: it drives over sills and ramps and under what hangs, and sees none of them.
Its lidar looks through glass and is reflected by mirrors all the same.

Lengths in metres, angles in radians unless they carry a unit; x to the right, y up.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from explore_bt.maps import MarkedFile
from explore_bt.types import Pose2
from explore_bt.units import LENGTH
from explore_bt_drivers.world.changes import read_moved, read_shut
from explore_bt_drivers.world.index import winding
from explore_bt_drivers.world.materials import read_material
from explore_bt_drivers.world.people import Room, read_people
from explore_bt_drivers.world.plan import Thing, WorldPlan
from explore_bt_drivers.world.ramps import read_ramps
from explore_bt_drivers.world.shapes import read_furniture
from explore_bt_drivers.world.solid import Solid, outline_edges
from explore_bt_drivers.world.walls import Door, DoorError, Wall, cut_doors, door_leaf, door_sill, wall_solid

__all__ = ["FORMAT", "read_world_file"]

FORMAT = "explore-bt-world/1"
_KEYS = ("name", "start", "bounds", "wall", "rooms", "walls", "doors", "furniture", "ramps", "people")
_WALL_KEYS = ("name", "closed", "thickness", "height", "material")
_WALL_THICKNESS_M, _WALL_HEIGHT_M, _FURNITURE_HEIGHT_M = 0.1, 2.5, 0.8
_DOOR_WIDTH_M = 0.9
_HIGHEST_SILL_M = 0.03


def read_world_file(path: Path) -> WorldPlan:
    """Read a world.

    Raises:
        WorldError: with every fault of the file, each with line, column and a hint.
    """
    file = MarkedFile(path)
    keys = file.fields(file.root("a world"), "the world", required=("format",), optional=_KEYS)
    _check_format(file, keys.get("format"))
    name = file.text(keys.get("name"), "name") or path.stem
    start = file.pose(keys.get("start"))
    walls = _read_walls(file, keys)
    walls, things, sills = _read_doors(file, keys.get("doors"), walls)
    solids = [wall_solid(wall) for wall in walls]
    furniture = [
        read_furniture(file, node, _FURNITURE_HEIGHT_M)
        for node in file.items(keys.get("furniture"), "furniture")
    ]
    solids += [solid for piece, _ in furniture for solid in piece.solids]
    overhangs = [solid for piece, _ in furniture for solid in piece.overhangs]
    ramps = read_ramps(file, keys.get("ramps"))
    bounds = _read_bounds(file, keys.get("bounds"), [*solids, *overhangs])
    for piece, moved in furniture:
        things += read_moved(file, moved, piece, bounds)
    people = read_people(file, keys.get("people"), None if bounds is None else Room(solids, bounds))
    if bounds is None and not file.fault_count:
        file.fault(keys["format"], "the world is empty; draw rooms, walls or furniture, or give its bounds")
    file.raise_faults()
    assert bounds is not None
    place = None if start is None else Pose2(*start)
    return WorldPlan(
        name,
        tuple(solids),
        bounds,
        place,
        tuple(things),
        tuple(people),
        tuple(overhangs),
        tuple(sills),
        tuple(ramps),
    )


def _check_format(file: MarkedFile, node: yaml.Node | None) -> None:
    if node is not None and node.value != FORMAT:
        file.fault(node, f"format is {node.value}; this version reads {FORMAT}")


def _read_walls(file: MarkedFile, keys: dict[str, yaml.Node]) -> list[Wall]:
    thickness, height = _WALL_THICKNESS_M, _WALL_HEIGHT_M
    if "wall" in keys:
        wall = file.fields(keys["wall"], "wall", optional=("thickness", "height"))
        thickness = file.quantity(wall.get("thickness"), LENGTH, "thickness", low=0.005) or thickness
        height = file.quantity(wall.get("height"), LENGTH, "height", low=0.01) or height
    walls: list[Wall] = []
    for node in file.items(keys.get("rooms"), "rooms"):
        walls += _read_room(file, node, thickness, height)
    for number, node in enumerate(file.items(keys.get("walls"), "walls"), start=1):
        walls += _read_wall(file, node, f"wall {number}", thickness, height)
    return walls


def _read_room(file: MarkedFile, node: yaml.Node, thickness_m: float, height_m: float) -> list[Wall]:
    keys = file.fields(node, "a room", required=("name", "box"))
    name = file.text(keys.get("name"), "name")
    box = file.lengths(keys.get("box"), "x0 y0 x1 y1")
    if name is None or box is None:
        return []
    x0, y0, x1, y1 = box
    if min(abs(x1 - x0), abs(y1 - y0)) <= 2 * thickness_m:
        size = f"{abs(x1 - x0):g} m by {abs(y1 - y0):g} m"
        file.fault(keys["box"], f"room {name} is {size}; its walls leave no floor")
        return []
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    return [Wall(f"wall of {name}", a, b, thickness_m, height_m) for a, b in itertools.pairwise(corners)]


def _read_wall(
    file: MarkedFile, node: yaml.Node, nickname: str, thickness_m: float, height_m: float
) -> list[Wall]:
    keys = file.fields(node, "a wall", required=("path",), optional=_WALL_KEYS)
    name = file.text(keys.get("name"), "name") or nickname
    thickness = file.quantity(keys.get("thickness"), LENGTH, "thickness", low=0.005) or thickness_m
    height = file.quantity(keys.get("height"), LENGTH, "height", low=0.01) or height_m
    material = read_material(file, keys.get("material"))
    before = file.fault_count
    points = [file.lengths(item, "x y") for item in file.items(keys.get("path"), "path")]
    line = [(point[0], point[1]) for point in points if point is not None]
    if "path" not in keys or file.fault_count > before:
        return []
    if file.flag(keys.get("closed"), "closed") and line:
        line.append(line[0])
    if len(line) < 2 or any(a == b for a, b in itertools.pairwise(line)):
        file.fault(keys["path"], f"the path of {name} needs two or more points, none twice in a row")
        return []
    return [Wall(name, a, b, thickness, height, material=material) for a, b in itertools.pairwise(line)]


def _read_doors(
    file: MarkedFile, node: yaml.Node | None, walls: list[Wall]
) -> tuple[list[Wall], list[Thing], list[Solid]]:
    """The walls with openings for the doors, the leaves of those that are shut at times, and sills."""
    doors: list[tuple[yaml.Node, Door]] = []
    leaves: list[Thing] = []
    sills: list[Solid] = []
    for number, item in enumerate(file.items(node, "doors"), start=1):
        keys = file.fields(item, "a door", required=("at",), optional=("name", "width", "shut", "sill"))
        name = file.text(keys.get("name"), "name") or str(number)
        width = file.quantity(keys.get("width"), LENGTH, "width", low=0.01) or _DOOR_WIDTH_M
        sill = file.quantity(keys.get("sill"), LENGTH, "sill", low=0.001, high=_HIGHEST_SILL_M)
        at = file.lengths(keys.get("at"), "x y")
        if at is None:
            continue
        door = Door(name, (at[0], at[1]), width)
        try:
            opened = cut_doors(walls, door)
        except DoorError as error:
            file.fault(keys["at"], str(error))
            continue
        leaves += read_shut(file, keys.get("shut"), door_leaf(walls, door))
        sills += [] if sill is None else [door_sill(walls, door, sill)]
        walls = opened
        doors.append((keys["at"], door))
    for place, door in doors:
        _check_opening(file, place, door, walls)
    return walls, leaves, sills


def _check_opening(file: MarkedFile, place: yaml.Node, door: Door, walls: Sequence[Wall]) -> None:
    """A wall that crosses an opening is a slip: the door would look open and be shut."""
    for wall in walls:
        if winding(outline_edges(wall_solid(wall).corners), *door.at) > 0:
            file.fault(place, f"door {door.name} is blocked by {wall.name}, which crosses it; move the door")


def _read_bounds(
    file: MarkedFile, node: yaml.Node | None, solids: Sequence[Solid]
) -> tuple[float, float, float, float] | None:
    if node is not None:
        box = file.lengths(node, "x0 y0 x1 y1")
        if box is not None and (box[0] >= box[2] or box[1] >= box[3]):
            file.fault(node, "bounds run from the lower left corner to the upper right one: x0 < x1, y0 < y1")
            return None
        return None if box is None else (box[0], box[1], box[2], box[3])
    if not solids:
        return None
    corners = np.concatenate([solid.corners for solid in solids])
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    return (float(x0), float(y0), float(x1), float(y1))

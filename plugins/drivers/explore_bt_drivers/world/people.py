"""People of a world file: who they are, and whether they fit where they walk."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import yaml

from explore_bt.maps import MarkedFile
from explore_bt.units import DURATION, LENGTH, SPEED
from explore_bt_drivers.world.index import SegmentIndex, build_index, fits, nearest, winding
from explore_bt_drivers.world.plan import Person
from explore_bt_drivers.world.solid import Solid, box_corners, outline_edges

__all__ = ["PEOPLE_KEYS", "Room", "read_people"]

PEOPLE_KEYS = ("name", "route", "speed", "radius", "pause", "begin")
_SPEED_MPS, _RADIUS_M = 1.2, 0.25
_SPACING_M = 0.05
_TOUCH_M = 1e-3


class Room:
    """What stands in a world as drawn, and its edge: says whether a person fits."""

    def __init__(self, solids: Sequence[Solid], bounds: tuple[float, float, float, float]) -> None:
        self._solids = solids
        self._bounds = bounds
        outlines = [box_corners(*bounds)[::-1], *(solid.corners for solid in solids)]
        self._owners = np.repeat(np.arange(len(outlines)), [len(corners) for corners in outlines])
        edges = np.concatenate([outline_edges(corners) for corners in outlines])
        self._index: SegmentIndex = build_index(np.ascontiguousarray(edges))

    def fault_at(self, x: float, y: float, radius_m: float) -> str | None:
        """Why a disc does not fit there, in words that follow "is"; None if it does."""
        x0, y0, x1, y1 = self._bounds
        if not (x0 <= x <= x1 and y0 <= y <= y1):
            return f"outside the world, which reaches from [{x0:g}, {y0:g}] to [{x1:g}, {y1:g}]"
        for solid in self._solids:
            if winding(outline_edges(solid.corners), x, y) > 0:
                return f"inside {solid.name}"
        distance, segment = nearest(self._index, x, y, radius_m - _TOUCH_M)
        if segment < 0:
            return None
        owner = int(self._owners[segment])
        thing = self._solids[owner - 1].name if owner else "the edge of the world"
        return f"{distance:.3f} m from {thing}"

    def fault_between(
        self, begin: tuple[float, float], end: tuple[float, float], radius_m: float
    ) -> str | None:
        """Where a disc that fits at both ends does not between them, and why; None if it does."""
        count = math.ceil(math.dist(begin, end) / _SPACING_M) + 1
        places = np.linspace(begin, end, count)
        tight = np.flatnonzero(~fits(self._index, places, radius_m - _TOUCH_M))
        if len(tight) == 0:
            return None
        x, y = (float(value) for value in places[tight[0]])
        return f"[{x:.2f}, {y:.2f}], which is {self.fault_at(x, y, radius_m)}"


def read_people(file: MarkedFile, node: yaml.Node | None, room: Room | None) -> list[Person]:
    """All entries of ``people``: ``{name, route, speed, radius, pause, begin}``.

    Args:
        file: takes the faults.
        node: the list; None if there is none.
        room: where they have to fit; None leaves that out, as the world is faulty anyway.
    """
    people = [_read_person(file, item, room) for item in file.items(node, "people")]
    return [person for person in people if person is not None]


def _read_person(file: MarkedFile, node: yaml.Node, room: Room | None) -> Person | None:
    keys = file.fields(node, "a person", required=PEOPLE_KEYS[:2], optional=PEOPLE_KEYS[2:])
    before = file.fault_count
    name = file.text(keys.get("name"), "name")
    speed = file.quantity(keys.get("speed"), SPEED, "speed", low=0.01)
    radius = file.quantity(keys.get("radius"), LENGTH, "radius", low=0.05, high=1.0)
    pause = file.quantity(keys.get("pause"), DURATION, "pause", low=0.0)
    begin = file.quantity(keys.get("begin"), DURATION, "begin", low=0.0)
    nodes = file.items(keys.get("route"), "route")
    points = [file.lengths(item, "x y") for item in nodes]
    route = tuple((point[0], point[1]) for point in points if point is not None)
    if name is None or "route" not in keys or file.fault_count > before:
        return None
    if len(route) < 2 or any(a == b for a, b in itertools.pairwise(route)):
        file.fault(keys["route"], f"the route of {name} needs two or more points, none twice in a row")
        return None
    person = Person(name, route, speed or _SPEED_MPS, radius or _RADIUS_M, pause or 0.0, begin or 0.0)
    if room is not None:
        _check_route(file, nodes, person, room)
    return person


def _check_route(file: MarkedFile, nodes: Sequence[yaml.Node], person: Person, room: Room) -> None:
    needs = f"{person.name} needs {person.radius_m:g} m on either side"
    faults = [room.fault_at(x, y, person.radius_m) for x, y in person.route]
    for node, (x, y), fault in zip(nodes, person.route, faults, strict=True):
        if fault is not None:
            file.fault(node, f"[{x:g}, {y:g}] is {fault}; {needs}: move the point")
    for i, (begin, end) in enumerate(itertools.pairwise(person.route)):
        if faults[i] is None and faults[i + 1] is None:
            fault = room.fault_between(begin, end, person.radius_m)
            if fault is not None:
                file.fault(
                    nodes[i + 1], f"the way here leads through {fault}; {needs}: add a point to go round"
                )

"""Walls along centre lines, with doors cut out of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from explore_bt_drivers.world.solid import Material, Solid

__all__ = ["Door", "DoorError", "Wall", "cut_doors", "door_leaf", "door_sill", "wall_solid"]

_SLACK = 1e-6
_LEAF_M = 0.04


class DoorError(Exception):
    """A door that lies in no wall, or is wider than its wall; says so in words."""


@dataclass(frozen=True, slots=True)
class Wall:
    """A straight wall: x, y of the ends of its centre line in metres; which ends close a corner."""

    name: str
    begin: tuple[float, float]
    end: tuple[float, float]
    thickness_m: float
    height_m: float
    capped: tuple[bool, bool] = (True, True)
    material: Material = Material.MATT

    @property
    def length_m(self) -> float:
        """Length of the centre line."""
        return math.dist(self.begin, self.end)

    def station(self, point: tuple[float, float]) -> tuple[float, float]:
        """Metres along the centre line and to its left of a point."""
        dx, dy = (self.end[0] - self.begin[0]) / self.length_m, (self.end[1] - self.begin[1]) / self.length_m
        px, py = point[0] - self.begin[0], point[1] - self.begin[1]
        return (px * dx + py * dy, dx * py - dy * px)

    def piece(self, low_m: float, high_m: float) -> Wall:
        """The part between two stations; cut ends close no corner."""
        return replace(
            self,
            begin=self._at(low_m),
            end=self._at(high_m),
            capped=(self.capped[0] and low_m <= 0.0, self.capped[1] and high_m >= self.length_m),
        )

    def _at(self, station_m: float) -> tuple[float, float]:
        share = station_m / self.length_m
        return (
            self.begin[0] + share * (self.end[0] - self.begin[0]),
            self.begin[1] + share * (self.end[1] - self.begin[1]),
        )


@dataclass(frozen=True, slots=True)
class Door:
    """An opening, centred on a point of a wall's centre line."""

    name: str
    at: tuple[float, float]
    width_m: float


def cut_doors(walls: Sequence[Wall], door: Door) -> list[Wall]:
    """The walls with one opening more; walls that lie upon each other are all opened.

    Raises:
        DoorError: no wall there, or the wall is too short.
    """
    hosts = [wall for wall in walls if _hosts(wall, door)]
    if not hosts:
        raise DoorError(f"door {door.name} lies in no wall; {_nearest_hint(walls, door)}")
    wide = [wall for wall in hosts if _room_for(wall, door) >= -_SLACK]
    if not wide:
        best = max(hosts, key=lambda wall: _room_for(wall, door))
        beyond = -_room_for(best, door)
        raise DoorError(
            f"door {door.name} is {door.width_m:g} m wide and reaches {beyond:.2f} m past the end of "
            f"{best.name}; move it along the wall or make it narrower"
        )
    return [piece for wall in walls for piece in (_split(wall, door) if wall in hosts else [wall])]


def door_leaf(walls: Sequence[Wall], door: Door) -> Solid:
    """What fills the opening of a door while it is shut: of its wall's kind, but 4 cm thick at most.

    Args:
        walls: before the door is cut out of them; one holds it.
        door: of which ``cut_doors`` has nothing to complain.
    """
    opening = _opening(walls, door)
    return wall_solid(
        replace(opening, name=f"door {door.name}", thickness_m=min(_LEAF_M, opening.thickness_m))
    )


def door_sill(walls: Sequence[Wall], door: Door, height_m: float) -> Solid:
    """What lies in the opening of a door, as thick as its wall; arguments as of ``door_leaf``."""
    sill = replace(_opening(walls, door), name=f"sill of door {door.name}", height_m=height_m)
    return wall_solid(replace(sill, material=Material.MATT))


def _opening(walls: Sequence[Wall], door: Door) -> Wall:
    wall = next(wall for wall in walls if _hosts(wall, door))
    along, _ = wall.station(door.at)
    opening = wall.piece(along - door.width_m / 2, along + door.width_m / 2)
    return replace(opening, capped=(False, False))


def wall_solid(wall: Wall) -> Solid:
    """The wall's rectangle; ends that close a corner reach half a thickness further."""
    (x0, y0), (x1, y1) = wall.begin, wall.end
    half = wall.thickness_m / 2
    dx, dy = (x1 - x0) / wall.length_m * half, (y1 - y0) / wall.length_m * half
    if wall.capped[0]:
        x0, y0 = x0 - dx, y0 - dy
    if wall.capped[1]:
        x1, y1 = x1 + dx, y1 + dy
    corners = [(x0 + dy, y0 - dx), (x1 + dy, y1 - dx), (x1 - dy, y1 + dx), (x0 - dy, y0 + dx)]
    return Solid(wall.name, np.array(corners), wall.height_m, wall.material)


def _hosts(wall: Wall, door: Door) -> bool:
    along, across = wall.station(door.at)
    return abs(across) <= wall.thickness_m / 2 + _SLACK and 0.0 < along < wall.length_m


def _room_for(wall: Wall, door: Door) -> float:
    along, _ = wall.station(door.at)
    return min(along, wall.length_m - along) - door.width_m / 2


def _split(wall: Wall, door: Door) -> list[Wall]:
    along, _ = wall.station(door.at)
    low, high = along - door.width_m / 2, along + door.width_m / 2
    ends = [(0.0, low), (high, wall.length_m)]
    return [wall.piece(begin, end) for begin, end in ends if end - begin > _SLACK]


def _nearest_hint(walls: Sequence[Wall], door: Door) -> str:
    if not walls:
        return "the file draws no walls: add rooms or walls"

    def distance(wall: Wall) -> float:
        along, across = wall.station(door.at)
        return math.hypot(along - min(max(along, 0.0), wall.length_m), across)

    wall = min(walls, key=distance)
    along, _ = wall.station(door.at)
    x, y = wall.piece(min(max(along, 0.0), wall.length_m), wall.length_m + 1.0).begin
    return f"the nearest one is {wall.name}, at [{x:.2f}, {y:.2f}]"

"""A floor plan while it is drawn: spaces, doors between them, and what stands in them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

__all__ = ["WALL_M", "Box", "Door", "FloorPlan", "Piece", "Space", "rounded"]

WALL_M = 0.1
_CORNER_M = 0.2
_GRID_M = 0.05


def rounded(value: float) -> float:
    """The nearest multiple of 5 cm."""
    return round(round(value / _GRID_M) * _GRID_M, 2)


@dataclass(frozen=True, slots=True)
class Box:
    """An upright rectangle, metres: x0 < x1, y0 < y1."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Along x."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """Along y."""
        return self.y1 - self.y0

    def grown(self, margin_m: float) -> Box:
        """Larger by a margin on every side."""
        return Box(self.x0 - margin_m, self.y0 - margin_m, self.x1 + margin_m, self.y1 + margin_m)

    def meets(self, other: Box) -> bool:
        """Whether the two share more than an edge."""
        slack = 1e-6
        return (
            self.x0 < other.x1 - slack
            and other.x0 < self.x1 - slack
            and self.y0 < other.y1 - slack
            and other.y0 < self.y1 - slack
        )

    def holds(self, other: Box) -> bool:
        """Whether the other lies inside, edges included."""
        slack = 1e-6
        return (
            self.x0 <= other.x0 + slack
            and self.y0 <= other.y0 + slack
            and other.x1 <= self.x1 + slack
            and other.y1 <= self.y1 + slack
        )

    def moved(self, where: Callable[[float, float], tuple[float, float]]) -> Box:
        """The box of the two corners after a mirroring or a swap of the axes."""
        (ax, ay), (bx, by) = where(self.x0, self.y0), where(self.x1, self.y1)
        return Box(*(rounded(v) for v in (min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))))


@dataclass(frozen=True, slots=True)
class Space:
    """A room between the centre lines of its walls, or a corridor, which others' walls enclose."""

    name: str
    kind: str
    box: Box
    walled: bool = True

    @property
    def floor(self) -> Box:
        """Between the faces of the walls."""
        return self.box.grown(-WALL_M / 2)


@dataclass(frozen=True, slots=True)
class Door:
    """An opening centred on a point of a wall's centre line; ``upright`` if the wall runs along y."""

    name: str
    x: float
    y: float
    width_m: float
    upright: bool

    def zone(self, depth_m: float) -> Box:
        """What must stay clear on both sides of it."""
        along, across = self.width_m / 2 + 0.05, depth_m + WALL_M / 2
        half_x, half_y = (across, along) if self.upright else (along, across)
        return Box(self.x - half_x, self.y - half_y, self.x + half_x, self.y + half_y)

    def inside(self, floor: Box, depth_m: float) -> tuple[float, float] | None:
        """A point so deep behind the door in a floor; None if the door does not lead there."""
        for sign in (-1.0, 1.0):
            step = sign * (depth_m + WALL_M / 2)
            x, y = (self.x + step, self.y) if self.upright else (self.x, self.y + step)
            if floor.x0 < x < floor.x1 and floor.y0 < y < floor.y1:
                near = abs(self.x - x) + abs(self.y - y)
                if near <= depth_m + WALL_M:
                    return (x, y)
        return None


@dataclass(frozen=True, slots=True)
class Piece:
    """A piece of furniture.

    Attributes:
        shape: ``box``, ``circle`` (x, y, radius of ``numbers``) or ``polygon``.
        numbers: as the world file takes them, metres.
        legs_m: width of its four legs if it stands on legs.
    """

    name: str
    shape: str
    numbers: tuple[float, ...]
    height_m: float
    legs_m: float | None = None


@dataclass(slots=True)
class FloorPlan:
    """All of it.

    Attributes:
        outline: the centre line of the outer walls.
        openings: where spaces without walls meet; kept clear as doors are.
        start: x, y in metres, heading in degrees.
    """

    name: str
    outline: Box
    spaces: list[Space]
    doors: list[Door] = field(default_factory=list)
    openings: list[Door] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)
    start: tuple[float, float, float] | None = None

    def join(self, one: Space, other: Space, width_m: float, share: float, name: str | None = None) -> bool:
        """Open a door where two spaces touch, ``share`` of the way along; False if there is no room."""
        a, b = one.box, other.box
        for upright, touch, low, high in (
            (True, _common(a.x0, a.x1, b.x0, b.x1), max(a.y0, b.y0), min(a.y1, b.y1)),
            (False, _common(a.y0, a.y1, b.y0, b.y1), max(a.x0, b.x0), min(a.x1, b.x1)),
        ):
            room = high - low - width_m - 2 * _CORNER_M
            if touch is None or room < -1e-6:
                continue
            along = rounded(low + _CORNER_M + width_m / 2 + share * room)
            along = min(max(along, low + _CORNER_M + width_m / 2), high - _CORNER_M - width_m / 2)
            x, y = (touch, along) if upright else (along, touch)
            self.doors.append(Door(name or f"{one.name} - {other.name}", x, y, width_m, upright))
            return True
        return False

    def transformed(self, where: Callable[[float, float], tuple[float, float]]) -> FloorPlan:
        """The empty plan mirrored or with its axes swapped, moved to begin at (0, 0)."""
        outline = self.outline.moved(where)

        def place(x: float, y: float) -> tuple[float, float]:
            nx, ny = where(x, y)
            return (round(nx - outline.x0, 3), round(ny - outline.y0, 3))

        swaps = math.isclose(where(1.0, 0.0)[0], where(0.0, 0.0)[0], abs_tol=1e-9)
        doors, openings = (
            [Door(d.name, *place(d.x, d.y), d.width_m, d.upright != swaps) for d in holes]
            for holes in (self.doors, self.openings)
        )
        spaces = [Space(s.name, s.kind, s.box.moved(place), s.walled) for s in self.spaces]
        return FloorPlan(self.name, self.outline.moved(place), spaces, doors, openings)


def _common(a0: float, a1: float, b0: float, b1: float) -> float | None:
    """Where one range ends and the other begins."""
    pairs: Iterable[tuple[float, float]] = ((a1, b0), (b1, a0))
    return next((x for x, y in pairs if math.isclose(x, y, abs_tol=1e-6)), None)

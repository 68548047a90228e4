"""What a world file describes: solids on the floor, what becomes of them, who walks there."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt.types import Pose2
from explore_bt_drivers.world.ramps import Ramp
from explore_bt_drivers.world.solid import Solid

__all__ = ["Person", "Stand", "Thing", "WorldPlan"]


@dataclass(frozen=True, slots=True)
class Person:
    """Somebody who walks a route there and back again for ever, whatever stands in the way.

    Attributes:
        name: as people call them.
        route: two or more points, metres, world frame; straight lines between them.
        speed_mps: constant.
        radius_m: of the disc that a person is to a planar robot.
        pause_s: rest at every point of the route.
        begin_s: until then they stand at the first point.
    """

    name: str
    route: tuple[tuple[float, float], ...]
    speed_mps: float
    radius_m: float
    pause_s: float
    begin_s: float


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """How a thing stands from ``begin_s`` on; without solids it is out of the way, like an open door."""

    begin_s: float
    solids: tuple[Solid, ...]
    overhangs: tuple[Solid, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Thing:
    """A door's leaf, or furniture that does not stay where it was drawn.

    Attributes:
        name: as people call it.
        stands: in order of time; the first one, from 0 s on, is the drawn one.
    """

    name: str
    stands: tuple[Stand, ...]


@dataclass(frozen=True, slots=True)
class WorldPlan:
    """A world as drawn.

    Attributes:
        solids: all that stands there as drawn, the first stand of ``things`` included.
        bounds: x0, y0, x1, y1 in metres; the world ends there, its edge is solid.
        start: where the robot begins unless the mission says otherwise.
        things: what changes in the course of time.
        people: who walks there.
        overhangs: what hangs above the floor as drawn: table tops, cupboards; a planar robot passes below.
        sills: of doors, low enough to be driven over.
        ramps: the floor's slopes.
    """

    name: str
    solids: tuple[Solid, ...]
    bounds: tuple[float, float, float, float]
    start: Pose2 | None
    things: tuple[Thing, ...] = ()
    people: tuple[Person, ...] = ()
    overhangs: tuple[Solid, ...] = ()
    sills: tuple[Solid, ...] = ()
    ramps: tuple[Ramp, ...] = ()

"""Ways through space and time without an end."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from explore_bt_drivers.world import Person

__all__ = ["Knot", "Walk", "at_speed", "there_and_back"]

Knot = tuple[float, float, float]
"""A time in seconds and a place in metres, ``map`` frame."""


@dataclass(frozen=True, slots=True)
class Walk:
    """Somebody's radius in metres, and the knots of their way, times ascending, without an end."""

    radius_m: float
    knots: Iterator[Knot]


def at_speed(
    points: Iterable[tuple[float, float]], speed_mps: float, begin_s: float = 0.0, pause_s: float = 0.0
) -> Iterator[Knot]:
    """The knots of a way along points at constant speed, with a pause at each but the first."""
    time, last = begin_s, None
    for point in points:
        if last is None:
            yield (time, *point)
        elif point != last:
            time += math.dist(last, point) / speed_mps
            yield (time, *point)
            if pause_s > 0.0:
                time += pause_s
                yield (time, *point)
        last = point


def there_and_back(person: Person) -> Walk:
    """A person of the world file: to the end of the route and back again, for ever."""
    points = itertools.cycle((*person.route, *person.route[-2:0:-1]))
    return Walk(person.radius_m, at_speed(points, person.speed_mps, person.begin_s, person.pause_s))

"""How people walk along a way: slower where they turn, getting going and stopping in their time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator

from explore_bt_drivers.people.walks import Knot

__all__ = ["ACCELERATION_MPS2", "TURN_MPS", "as_people_walk"]

ACCELERATION_MPS2 = 2.0
TURN_MPS = 0.4
"""The change of velocity at a corner: a fifth of a second at that acceleration."""
_KNOTS_S = 0.1
_SOON_S = 1e-6
"""Times so near to one another are the same."""

_Point = tuple[float, float]


def as_people_walk(points: Iterable[_Point], speed_mps: float) -> Iterator[Knot]:
    """The knots of a way without an end, from 0 s on, at ``speed_mps`` where it is straight."""
    corners = _without_repeats(points)
    last, here = next(corners), next(corners)
    time_s, begin_mps = 0.0, 0.0
    yield (time_s, *last)
    for following in corners:
        length_m = math.dist(last, here)
        come_to_mps = math.sqrt(begin_mps**2 + 2.0 * ACCELERATION_MPS2 * length_m)
        end_mps = min(come_to_mps, _through(last, here, following, speed_mps))
        for after_s, share in _strides(length_m, begin_mps, end_mps, speed_mps):
            x, y = (begin + share * (end - begin) for begin, end in zip(last, here, strict=True))
            yield (time_s + after_s, x, y)
        time_s += after_s
        last, here, begin_mps = here, following, end_mps


def _without_repeats(points: Iterable[_Point]) -> Iterator[_Point]:
    return (point for point, _ in itertools.groupby(points))


def _through(last: _Point, here: _Point, following: _Point, speed_mps: float) -> float:
    """How fast somebody passes a corner: slowly enough to turn, and to stop at the next one."""
    into = math.atan2(here[1] - last[1], here[0] - last[0])
    out_of = math.atan2(following[1] - here[1], following[0] - here[0])
    bend = abs(math.sin(0.5 * (out_of - into)))
    to_turn = 0.5 * TURN_MPS / bend if bend > 0.0 else math.inf
    to_stop = math.sqrt(2.0 * ACCELERATION_MPS2 * math.dist(here, following))
    return min(speed_mps, to_turn, to_stop)


def _strides(
    length_m: float, begin_mps: float, end_mps: float, most_mps: float
) -> Iterator[tuple[float, float]]:
    """Seconds from the begin of a straight way, and the share of it come along, up to (all the time, 1)."""
    rate = ACCELERATION_MPS2
    top = math.sqrt(0.5 * (begin_mps**2 + end_mps**2) + rate * length_m)
    top = max(min(top, most_mps), begin_mps, end_mps)  # these it is below by rounding alone
    rising_s, falling_s = (top - begin_mps) / rate, (top - end_mps) / rate
    risen_m = 0.5 * (begin_mps + top) * rising_s
    fallen_m = 0.5 * (end_mps + top) * falling_s
    level_s = max(length_m - risen_m - fallen_m, 0.0) / top
    for after_s in _every(_KNOTS_S, rising_s):
        yield after_s, (begin_mps + 0.5 * rate * after_s) * after_s / length_m
    whole_s = rising_s + level_s + falling_s
    if rising_s > _SOON_S and level_s + falling_s > _SOON_S:
        yield rising_s, risen_m / length_m
    if level_s > _SOON_S and falling_s > _SOON_S:
        yield rising_s + level_s, 1.0 - fallen_m / length_m
    for after_s in _every(_KNOTS_S, falling_s):
        left_s = falling_s - after_s
        yield whole_s - left_s, 1.0 - (end_mps + 0.5 * rate * left_s) * left_s / length_m
    yield whole_s, 1.0


def _every(period_s: float, until_s: float) -> Iterator[float]:
    """Multiples of a period, up to before a time."""
    return itertools.takewhile(lambda at_s: at_s < until_s - _SOON_S, itertools.count(period_s, period_s))

"""Places that together show all that is still to be seen, in an order that makes a short way."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.outlook import Outlook, Outlooks
from explore_bt.exploration.tour import open_tour
from explore_bt.exploration.view_places import ViewPlaces

__all__ = ["TourTaste", "View", "ViewSet", "choose_views", "first_run", "order_views"]

_KEPT_WORTH = 1.5
_BEYOND_M = 10.0
_APART_M = 1e3
_SAME_M = 0.1
_MORE_FOR_EACH = 4
"""So many views more for every other robot."""


@dataclass(frozen=True, slots=True)
class View:
    """A place to look from.

    Attributes:
        xy: metres, ``map`` frame.
        gain_m2: unknown area that it shows and no view chosen before it does.
        travel_m: way from the robot, tight metres counting more.
        block: where it lies among the blocks that ways are measured over.
    """

    xy: tuple[float, float]
    gain_m2: float
    travel_m: float
    block: tuple[int, int]

    def worth(self, decay_per_m: float) -> float:
        """Area · exp(-decay · way), m² (González-Baños & Latombe, 2002)."""
        return self.gain_m2 * math.exp(-decay_per_m * self.travel_m)


@dataclass(frozen=True, slots=True, eq=False)
class ViewSet:
    """Views that together show what there is to see.

    Attributes:
        views: near ones first; none where no place shows enough.
        between_m: (N + 1, N + 1) metres between the robot (first) and them.
        total_m2: what all places in reach show, also those beyond the horizon.
        from_others_m: (R, N) metres between R other robots and them.
    """

    views: tuple[View, ...]
    between_m: NDArray[np.float64]
    total_m2: float
    from_others_m: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))

    def only(self, numbers: Sequence[int]) -> ViewSet:
        """Some of the views, by their indices."""
        rows = [0, *(number + 1 for number in numbers)]
        return ViewSet(
            tuple(self.views[number] for number in numbers),
            self.between_m[np.ix_(rows, rows)],
            self.total_m2,
            self.from_others_m[:, list(numbers)],
        )


@dataclass(frozen=True, slots=True)
class TourTaste:
    """What a tour is made by.

    Attributes:
        min_gain_m2: least new area that is worth a drive.
        depth_m: how far into the unknown an opening is believed: the cheap guess of what lies behind.
        most: views that are ordered at a time.
        horizon_m: views farther than this (or 10 m more than the nearest) are left for later.
        approach_m: what a view costs besides the way to it.
        haste: see :func:`open_tour`.
        scrap_weight: what the least view weighs in it, beside its gain up to 3 m².
        keep_m: by how much another tour has to be shorter to turn the robot away from its goal.
        large_m2: a view that shows so much leads: the tour begins with the way to it.
        decay_per_m: how fast what a view shows loses worth with the way, in choosing that one.
        aside_m: what passing another view may add to the way there.
    """

    min_gain_m2: float = 0.1
    depth_m: float = 1.5
    most: int = 12
    horizon_m: float = 20.0
    approach_m: float = 1.0
    haste: float = 3.0
    scrap_weight: float = 1.0
    keep_m: float = 1.0
    large_m2: float = 3.0
    decay_per_m: float = 0.2
    aside_m: float = 2.0


@njit(cache=True)
def _count_new(begin, cells, covered, active):  # type: ignore[no-untyped-def]  # numba kernel
    """Cells not yet covered that each active place sees; 0 for the others."""
    new = np.zeros(begin.size - 1, dtype=np.int64)
    for i in range(begin.size - 1):
        if active[i]:
            for k in range(begin[i], begin[i + 1]):
                if not covered[cells[k]]:
                    new[i] += 1
    return new


def choose_views(
    places: ViewPlaces,
    outlooks: Outlooks,
    range_m: float,
    taste: TourTaste,
    kept_xy: NDArray[np.float64] | None = None,
    claimed_xy: NDArray[np.float64] | None = None,
    others_xy: NDArray[np.float64] | None = None,
) -> ViewSet:
    """Few views that together show what the places can show, near ones first.

    Greedy set cover, where a set costs the way to it from the nearest view chosen so far (or a robot).

    Args:
        places: where the robot may look from.
        outlooks: remembers what they see.
        range_m: the lidar's range.
        taste: see there.
        kept_xy: (K, 2) metres, the present goal and the places on the way; they count half as much again.
        claimed_xy: (K, 2) metres, places that others go to: what they show is as good as seen.
        others_xy: (R, 2) metres, where other robots begin that views are to be found for, too.
    """
    others = [] if others_xy is None else [_ways_from(places, xy) for xy in others_xy]
    nothing = ViewSet((), np.zeros((1, 1)), 0.0)
    if not len(places.blocks):
        return nothing
    min_patch_m2 = 0.5 * taste.min_gain_m2
    outlook, cell_m2, size = places.look(outlooks, range_m, taste.depth_m, min_patch_m2)
    active = np.diff(outlook.begin) * cell_m2 >= taste.min_gain_m2
    active &= np.isfinite(places.travel_m)
    near = np.min(
        [field[tuple(places.way_blocks.T)] for field in (places.reach.from_here_m, *others)], axis=0
    )
    if not active.any():
        return nothing
    total_m2 = float(np.count_nonzero(_cover(outlook, active, size))) * cell_m2
    horizon_m = max(taste.horizon_m, float(near[active].min()) + _BEYOND_M)
    active &= near <= horizon_m
    favour = _favour(places, kept_xy)
    views: list[View] = []
    fields = [places.reach.from_here_m]
    covered = np.zeros(size, dtype=np.bool_)
    if claimed_xy is not None and len(claimed_xy):
        covered[places.look_from(claimed_xy, outlooks, range_m, taste.depth_m, min_patch_m2).cells] = True
    while len(views) < taste.most + _MORE_FOR_EACH * len(others):
        gain_m2 = _count_new(outlook.begin, outlook.cells, covered, active) * cell_m2
        active &= gain_m2 >= taste.min_gain_m2
        if not active.any():
            break
        best = int(np.argmax(np.where(active, favour * gain_m2 / (near + taste.approach_m), -1.0)))
        row, col = places.way_blocks[best].tolist()
        x, y = places.xy[best].tolist()
        views.append(View((x, y), float(gain_m2[best]), float(places.travel_m[best]), (row, col)))
        covered[_seen(outlook, best)] = True
        active[best] = False
        fields.append(places.reach.ways_m((row, col), 2.0 * horizon_m))
        near = np.minimum(near, fields[-1][tuple(places.way_blocks.T)])
    if not views:
        return ViewSet((), np.zeros((1, 1)), total_m2)
    return ViewSet(tuple(views), _between(fields, views), total_m2, _to_views(others, views))


def _ways_from(places: ViewPlaces, xy: NDArray[np.float64]) -> NDArray[np.float32]:
    """Metres from another robot to each block that ways are measured over; nothing where it cannot be."""
    ground = places.reach.ground
    block = places.reach.way_block_of(ground.block_of(xy[None]))[0]
    rows, cols = places.reach.from_here_m.shape
    if not (0 <= block[0] < rows and 0 <= block[1] < cols):
        return np.full((rows, cols), np.inf, dtype=np.float32)
    return places.reach.ways_m((int(block[0]), int(block[1])))


def _to_views(fields: list[NDArray[np.float32]], views: list[View]) -> NDArray[np.float64]:
    rows, cols = np.array([view.block for view in views]).T
    ways_m = np.array([ways[rows, cols] for ways in fields], dtype=np.float64).reshape(-1, len(views))
    return np.where(np.isfinite(ways_m), ways_m, _APART_M)


def _cover(outlook: Outlook, active: NDArray[np.bool_], size: int) -> NDArray[np.bool_]:
    covered = np.zeros(size, dtype=np.bool_)
    covered[outlook.cells[np.repeat(active, np.diff(outlook.begin))]] = True
    return covered


def _favour(places: ViewPlaces, kept_xy: NDArray[np.float64] | None) -> NDArray[np.float64]:
    favour = np.ones(len(places.blocks))
    for xy in () if kept_xy is None else kept_xy:
        favour[np.hypot(*(places.xy - xy).T) < 0.5 * places.reach.ground.grid.resolution_m] = _KEPT_WORTH
    return favour


def _seen(outlook: Outlook, place: int) -> NDArray[np.int32]:
    return outlook.cells[outlook.begin[place] : outlook.begin[place + 1]]


def _between(fields: list[NDArray[np.float32]], views: list[View]) -> NDArray[np.float64]:
    rows, cols = np.array([view.block for view in views]).T
    between = np.zeros((len(fields), len(fields)))
    for row, ways_m in enumerate(fields):
        between[row, 1:] = ways_m[rows, cols]
    return np.where(np.isfinite(between), between, _APART_M)


def order_views(
    chosen: ViewSet,
    first_leg_m: Callable[[View], float],
    taste: TourTaste,
    kept_xy: NDArray[np.float64] | None = None,
) -> tuple[View, ...]:
    """The views in the order of an open tour that begins with the way to the most promising one.

    Args:
        chosen: as from :func:`choose_views`.
        first_leg_m: what it costs to go to a view next besides the way; so the rules for headings take part.
        taste: see there.
        kept_xy: (K, 2) metres, the present goal and the places on the way there.
    """
    views, between = chosen.views, chosen.between_m.copy()
    for k, view in enumerate(views):
        between[0, k + 1] += first_leg_m(view) - (taste.keep_m if _is_among(view, kept_xy) else 0.0)
    weight = np.array([0.0, *(taste.scrap_weight + min(view.gain_m2, 3.0) for view in views)])
    order = [int(k) for k in open_tour(between, weight, taste.haste)[1:]]
    return tuple(views[k - 1] for k in _led(order, chosen, taste, kept_xy))


def _led(
    order: list[int], chosen: ViewSet, taste: TourTaste, kept_xy: NDArray[np.float64] | None
) -> list[int]:
    """The places of the tour, with no more than ``aside_m`` spent on the way to the most promising one.

    So most floor comes early, and what the tour passes anyway is not left for a second visit.
    """
    views, between = chosen.views, chosen.between_m
    worth = [
        view.worth(taste.decay_per_m) * (_KEPT_WORTH if _is_among(view, kept_xy) else 1.0) for view in views
    ]
    lead = 1 + int(np.argmax(worth))
    if views[lead - 1].gain_m2 < taste.large_m2:
        return order
    way = [0]
    for k in order[: order.index(lead)]:
        here = way[-1]
        if between[here, k] + between[k, lead] - between[here, lead] <= taste.aside_m:
            way.append(k)
    way.append(lead)
    return way[1:] + [k for k in order if k not in way]


def _is_among(view: View, places_xy: NDArray[np.float64] | None) -> bool:
    return places_xy is not None and bool((np.hypot(*(places_xy - view.xy).T) < _SAME_M).any())


def first_run(
    chosen: ViewSet, order: Sequence[View], detour_m: float, end_xy: tuple[float, float] | None = None
) -> tuple[View, ...]:
    """The views that lie one behind another as a tour begins: the robot passes all but the last of them.

    At none of them it turns by more than a right angle: there it would all but stop.

    Args:
        chosen: as from :func:`choose_views`.
        order: the tour, as from :func:`order_views`.
        detour_m: by how much the way over them may be longer than the way straight to the last.
        end_xy: where the present run ends; one that comes to it ends there too.
    """
    number = {view: k for k, view in enumerate(chosen.views, start=1)}
    at, between = [0, number[order[0]]], chosen.between_m
    way_m = between[0, at[1]]
    for view in order[1:]:
        before, last, k = at[-2], at[-1], number[view]
        x, y = order[len(at) - 2].xy
        if end_xy is not None and np.hypot(x - end_xy[0], y - end_xy[1]) < _SAME_M:
            break
        way_m += between[last, k]
        turns_back = between[before, k] ** 2 < between[before, last] ** 2 + between[last, k] ** 2
        if turns_back or way_m > between[0, k] + detour_m:
            break
        at.append(k)
    return tuple(order[: len(at) - 1])

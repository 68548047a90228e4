"""The furnished flat as prisms, and a drive through all its rooms."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby

import numpy as np
from explore_bt_drivers.world import Solid, read_world_file
from machine import ROOT

from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.types import Measurement

__all__ = ["APARTMENT", "flat", "tour"]

APARTMENT = ROOT / "missions" / "worlds" / "apartment.yaml"
_TOP_M = 0.04
# fmt: off
_WAY = (
    (4.2, 4.3), (5.9, 4.4), (5.9, 3.2), (6.6, 2.4), (5.9, 3.2), (6.0, 4.4), (8.9, 4.5), (9.6, 4.2),
    (9.6, 3.2), (10.0, 2.0), (9.6, 3.2), (9.7, 4.4), (9.7, 5.6), (9.8, 6.6), (9.7, 5.6), (8.2, 5.6),
    (6.2, 5.5), (6.2, 4.4), (4.5, 4.3), (4.2, 5.4), (2.6, 6.3), (1.4, 5.6), (1.4, 4.2), (1.4, 2.4),
    (3.2, 1.4), (3.3, 3.6),
)
# fmt: on


def flat() -> Scene3:
    """Walls and furniture of the world that ships; a table on legs gets its top back."""
    solids = read_world_file(APARTMENT).solids
    prisms = [Prism(solid.corners, 0.0, solid.height_m) for solid in solids]
    for _, group in groupby(solids, key=lambda solid: solid.name):
        legs = list(group)
        if len(legs) == 4 and all(len(leg.corners) == 4 for leg in legs) and "wall" not in legs[0].name:
            prisms.append(_table_top(legs))
    return Scene3(prisms)


def _table_top(legs: list[Solid]) -> Prism:
    corners = np.concatenate([leg.corners for leg in legs])
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    box = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    return Prism(box, legs[0].height_m - _TOP_M, legs[0].height_m)


def tour(robot: BalancingRobot) -> Iterator[Measurement]:
    """Once through all rooms, with a whole spin at every fourth place."""
    for number, (x, y) in enumerate(_WAY):
        yield from robot.go_to(x, y)
        if number % 4 == 0:
            yield from robot.turn(2.0 * math.pi * (-1) ** (number // 4))

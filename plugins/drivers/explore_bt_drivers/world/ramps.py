"""Slopes of the floor: up, level for a while, and down again."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import yaml
from numpy.typing import NDArray

from explore_bt.maps import MarkedFile
from explore_bt.types import Pose2
from explore_bt.units import ANGLE, LENGTH

__all__ = ["Ramp", "read_ramps"]

_STEEPEST_RAD = math.radians(3.0)
_SLOPE_RAD = math.radians(2.0)
_SLACK = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Ramp:
    """A low ridge across the floor, the same at every place of its width.

    Attributes:
        name: as people call it.
        middle: of its box; it rises along x of this pose, ``map`` frame.
        length_m: along x, both slopes and what is level between them.
        width_m: along y.
        level_m: length of the level part in the middle.
        rise_m: height of the level part.
    """

    name: str
    middle: Pose2
    length_m: float
    width_m: float
    level_m: float
    rise_m: float

    @property
    def corners(self) -> NDArray[np.float64]:
        """(8, 3) float64, metres, ``map`` frame: of the convex body, its feet first."""
        half, flat, side = self.length_m / 2, self.level_m / 2, self.width_m / 2
        feet = [(-half, -side), (half, -side), (half, side), (-half, side)]
        ridge = [(-flat, -side), (flat, -side), (flat, side), (-flat, side)]
        xy = self.middle.apply(np.array([*feet, *ridge]))
        return np.column_stack((xy, np.repeat((0.0, self.rise_m), 4)))


def read_ramps(file: MarkedFile, node: yaml.Node | None) -> list[Ramp]:
    """All entries of ``ramps``: ``{name, box, turn, slope, level}``."""
    ramps = [_read_ramp(file, item) for item in file.items(node, "ramps")]
    return [ramp for ramp in ramps if ramp is not None]


def _read_ramp(file: MarkedFile, node: yaml.Node) -> Ramp | None:
    keys = file.fields(node, "a ramp", required=("name", "box"), optional=("turn", "slope", "level"))
    name = file.text(keys.get("name"), "name")
    turn = file.quantity(keys.get("turn"), ANGLE, "turn") or 0.0
    slope = file.quantity(keys.get("slope"), ANGLE, "slope", low=0.001, high=_STEEPEST_RAD + _SLACK)
    level = file.quantity(keys.get("level"), LENGTH, "level", low=0.0) or 0.0
    box = file.lengths(keys.get("box"), "x0 y0 x1 y1")
    if name is None or box is None:
        return None
    length, width = abs(box[2] - box[0]), abs(box[3] - box[1])
    if length - level <= _SLACK or width <= _SLACK:
        file.fault(
            keys["box"],
            f"ramp {name} is {length:g} m long, {level:g} m of it level, and {width:g} m wide; "
            "expected a box wider than nothing and longer than its level part",
        )
        return None
    rise = (length - level) / 2 * math.tan(_SLOPE_RAD if slope is None else slope)
    middle = Pose2((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, turn)
    return Ramp(name, middle, length, width, level, rise)

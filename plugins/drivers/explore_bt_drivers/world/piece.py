"""A piece of furniture: what of it stands on the floor, and what it carries."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_drivers.world.solid import Solid

__all__ = ["Piece"]


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Solids that move together.

    Attributes:
        name: as people call it.
        solids: on the floor.
        overhangs: above it: a table's top, a cupboard on the wall.
    """

    name: str
    solids: tuple[Solid, ...] = ()
    overhangs: tuple[Solid, ...] = ()

    @property
    def parts(self) -> tuple[Solid, ...]:
        """All of it."""
        return (*self.solids, *self.overhangs)

    @property
    def corners(self) -> NDArray[np.float64]:
        """(N, 2) float64 of all its parts, metres, world frame."""
        return np.concatenate([solid.corners for solid in self.parts])

    def moved(self, to: Pose2) -> Piece:
        """As it stands when the middle of the box round all of it is at ``to``, which also turns it."""
        corners = self.corners
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2

        def carried(solids: tuple[Solid, ...]) -> tuple[Solid, ...]:
            return tuple(replace(solid, corners=to.apply(solid.corners - middle)) for solid in solids)

        return Piece(self.name, carried(self.solids), carried(self.overhangs))

"""What the leaves that look for the next place to explore have in common."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.exploration import sentences, travel_field, what_remains
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Pose2, Waypoint
from explore_bt.units import Area

__all__ = ["HERE_M", "Search"]

HERE_M = 0.15
"""A place as near as this is where the robot stands."""


class Search(Leaf):
    """Base of leaves that put a place into ``goal``, or fail and say what stays open and why."""

    values = (GivenUp,)

    min_gain: Input[float] = Input(
        Area, default=0.1, ge=0.01, doc="less new area is not worth a drive, nor named"
    )
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="the place to go to")
    given_up: Output[tuple[GivenUp, ...]] = Output(
        tuple, default=Key("given_up"), doc="places not to try again"
    )
    left_open: Output[tuple[str, ...]] = Output(
        tuple, default=Key("left_open"), doc="what was not explored and why, one sentence each"
    )
    reason: Output[str] = Output(str, default=Key("reason"), doc="why the exploration is over")

    def here(self) -> Pose2:
        """Where the robot is."""
        return self.robot.estimate().T_map_base

    def tried(self) -> tuple[GivenUp, ...]:
        """The places given up so far."""
        return self.recall("given_up", ())

    def give_up(self, place: GivenUp) -> None:
        """Add to them."""
        self.given_up = (*self.tried(), place)

    def travel_m(self, xy: tuple[float, float], margin_m: float = 0.0) -> NDArray[np.float32]:
        """(rows, cols) metres from a place to every other, ``margin_m`` to spare beside the footprint."""
        view = self.robot.view()
        at = np.array([view.grid.cell_of(*xy)])
        return travel_field(
            view.clearance_m, at, self.robot.footprint_radius_m + margin_m, view.grid.resolution_m
        )

    def conclude(self, reason: str, further: Iterable[tuple[tuple[float, float], str]]) -> Status:
        """FAILURE: nothing is left to go for, for this reason; ``further`` places stay open besides."""
        view = self.robot.view()
        left = what_remains(
            view.grid,
            view.clearance_m,
            self.travel_m(self.here().xy),
            self.robot.footprint_radius_m,
            min_gain_m2=self.min_gain,
        )
        self.left_open = sentences((*left, *further))
        self.reason = reason
        self.say(reason)
        return Status.FAILURE

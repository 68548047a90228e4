"""Leaf: back out of a room that the map has closed behind the robot."""

from __future__ import annotations

import cv2
import numpy as np

from explore_bt.behaviours.retrace import Retrace, path_along
from explore_bt.exploration import clearance_at, way_back
from explore_bt.tree import Input, Status
from explore_bt.units import Length

__all__ = ["LeavePocket"]

_MORE = 1.2
"""A piece of ground this much larger than the one the robot stands on is worth going back to."""


class LeavePocket(Retrace):
    """Drives back along its own track to the largest piece of ground it has been on.

    A gap as wide as the robot may count as open from one side and as closed from the other, by half a cell.
    The robot came through, so it can go back, though no plan leads there.
    SUCCESS on the larger piece; FAILURE if it stands on it already, or the safety gate holds it on the way.
    """

    type_key = "leave_pocket"

    at_most: Input[float] = Input(Length, default=50.0, ge=0.1, doc="no farther back than this")

    def initialise(self) -> None:
        """Hand the controller the track, if it leads to more ground."""
        view, track = self.robot.view(), way_back(self.robot.trajectory().poses[:, :2], self.at_most)
        needed_m = self.robot.footprint_radius_m + max(self.robot.least_margin_m, 0.0)
        _, piece_of, stats, _ = cv2.connectedComponentsWithStats(
            (view.clearance_m >= needed_m).astype(np.uint8)
        )
        size = stats[:, cv2.CC_STAT_AREA].copy()
        size[0] = 0  # where the footprint does not fit
        rows, cols = view.grid.cells_of(track).T
        along = size[piece_of[rows, cols]]
        last = int(np.argmax(along))
        here = along[np.flatnonzero(along)[0]] if along.any() else 0
        self._here_m2 = float(here) * view.grid.resolution_m**2
        self._is_pocket = bool(along[last] > _MORE * here)
        if self._is_pocket:
            track = track[: last + 1]
            self.follow(path_along(track, clearance_at(view.grid, track, needed_m)))

    def update(self) -> Status:
        """Until it is left."""
        if not self._is_pocket:
            self.say(f"no larger piece of ground than this one of {self._here_m2:.1f} m² was ever driven on")
            return Status.FAILURE
        return self.watch()

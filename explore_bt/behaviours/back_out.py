"""Leaf: leave a tight place the way it was entered."""

from __future__ import annotations

import numpy as np

from explore_bt.behaviours.retrace import Retrace, path_along
from explore_bt.exploration import clearance_at, way_back
from explore_bt.tree import Input, Status
from explore_bt.types import way_along
from explore_bt.units import Length

__all__ = ["BackOut"]

_NEAR_M = 0.05
_CLEAR_OF_M = 0.5
"""Beyond the footprint, what the scan meets is near; and so far back from what is."""


class BackOut(Retrace):
    """Drives back along its own track to the first place with room around it.

    Where the footprint went in it fits out again, whatever the map's cells make of the passage. What the
    scan sees close by counts even where the map has nothing: a chair leg may be thinner than a cell.
    SUCCESS there; FAILURE if the track is too short, or the safety gate holds the robot on it.
    """

    type_key = "back_out"

    room: Input[float] = Input(
        Length, default=0.15, ge=0.0, doc="free space beyond the footprint that is enough"
    )
    at_least: Input[float] = Input(
        Length, default=0.5, ge=0.0, doc="so far back in any case; 0: not at all where there is room"
    )
    at_most: Input[float] = Input(Length, default=5.0, ge=0.1, doc="no farther back than this")

    def initialise(self) -> None:
        """Hand the controller the track."""
        track = way_back(self.robot.trajectory().poses[:, :2], self.at_most)
        clearance_m = clearance_at(self.robot.view().grid, track, self._enough_m)
        at_least_m = max(self.at_least, _CLEAR_OF_M) if self._is_scan_near() else self.at_least
        self._clear_m = float(clearance_m[0])
        self._has_room = bool(clearance_m[0] >= self._enough_m) and at_least_m == 0.0
        self._has_way = len(track) > 1
        if self._has_way and not self._has_room:
            along_m = way_along(track)
            is_enough = (clearance_m >= self._enough_m) & (along_m >= at_least_m) & (along_m > 0.0)
            last = int(np.argmax(is_enough)) if is_enough.any() else len(track) - 1
            self.follow(path_along(track[: last + 1], clearance_m[: last + 1]))

    def update(self) -> Status:
        """Until the place is reached."""
        if self._has_room:
            self.say(f"there is room here: {self._clear_m:.2f} m clear, {self._enough_m:.2f} m are enough")
            return Status.SUCCESS
        if not self._has_way:
            self.say("no way back: nothing driven yet")
            return Status.FAILURE
        return self.watch()

    def _is_scan_near(self) -> bool:
        """Whether the newest scan meets something so near that the safety gate may hold the robot."""
        scan = self.robot.scan()
        if scan is None:
            return False
        points = scan.points()
        return bool((np.hypot(points[:, 0], points[:, 1]) < self.robot.footprint_radius_m + _NEAR_M).any())

    @property
    def _enough_m(self) -> float:
        return self.robot.footprint_radius_m + self.room

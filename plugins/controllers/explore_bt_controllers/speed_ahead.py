"""The speeds that a path allows, and the greatest one from which they can all be kept."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, MotionState, Path
from explore_bt_controllers.look_ahead import fastest_velocity
from explore_bt_controllers.options import FollowerOptions
from explore_bt_controllers.track import Leg

__all__ = ["SpeedAhead"]

_SLOWEST_SHARE = 0.2


class SpeedAhead:
    """Speed limits along the legs of one path, kept for the leg and the limits they were made for."""

    def __init__(self, path: Path, options: FollowerOptions, footprint_radius_m: float) -> None:
        self._path = path
        self._options = options
        self._footprint_m = footprint_radius_m
        self._made_for: tuple[MotionLimits, Leg] | None = None
        self._limits_mps = np.zeros(0)
        self._room: tuple[Leg, NDArray[np.float64]] | None = None

    def limits_on(self, leg: Leg, limits: MotionLimits) -> NDArray[np.float64]:
        """(N,) float64 m/s: what bends and the room beside the footprint allow, sample by sample."""
        if self._made_for is None or self._made_for[0] is not limits or self._made_for[1] is not leg:
            self._made_for = (limits, leg)
            self._limits_mps = np.minimum(
                leg.speed_limits(limits, self._options.lateral_acceleration),
                limits.speed_mps * self._ease(self.room_on(leg)),
            )
        return self._limits_mps

    def fastest(
        self, leg: Leg, along_m: float, cap_mps: float, motion: MotionState, limits: MotionLimits, dt_s: float
    ) -> float:
        """The greatest next velocity (m/s) that keeps every limit ahead, and ends at the leg's end."""
        return float(
            fastest_velocity(
                motion.twist.linear_mps,
                motion.linear_acceleration_mps2,
                cap_mps,
                along_m,
                self.limits_on(leg, limits),
                leg.spacing_m,
                leg.length_m,
                dt_s,
                limits.speed_mps,
                limits.acceleration_mps2,
                limits.jerk_mps3,
            )
        )

    def least_room(self, leg: Leg, along_m: float, ahead_m: float) -> float:
        """Metres beside the footprint that the path leaves at its tightest within ``ahead_m``."""
        return float(self.room_on(leg)[leg.index_at(along_m) : leg.index_at(along_m + ahead_m) + 1].min())

    def room_on(self, leg: Leg) -> NDArray[np.float64]:
        """(N,) metres beside the footprint that the path leaves along a leg."""
        if self._room is None or self._room[0] is not leg:
            offsets = leg.points[:, None, :] - self._path.poses[None, :, :2]
            nearest = np.argmin(np.einsum("ijk,ijk->ij", offsets, offsets), axis=1)
            self._room = (leg, self._path.clearance_m[nearest] - self._footprint_m)
        return self._room[1]

    def _ease(self, room_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of full speed: less where little room is left beside the footprint."""
        return np.clip(room_m / max(self._options.slow_below, 1e-6), _SLOWEST_SHARE, 1.0)

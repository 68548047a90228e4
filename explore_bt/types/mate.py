"""Another robot of the team, as far as it has told."""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types.pose import Pose2, Twist2

__all__ = ["Doing", "Mate"]

_STANDS_MPS = 0.02


class Doing(enum.StrEnum):
    """What a robot is about, for its team.

    A paused one stands, and counts for nothing when work is divided: the others go on without it.
    """

    AT_WORK = "at work"
    IDLE = "idle"
    OVER = "over"
    PAUSED = "paused"


@dataclass(frozen=True, slots=True, eq=False)
class Mate:
    """Times are on the listener's clock, places in the ``map`` frame, metres.

    Attributes:
        stamp_s: when it was so.
        binding_s: until then it keeps to ``stop``.
        radius_m: of its footprint.
        speed_limit_mps: it is never faster.
        stop: (N, 2) float64: where its centre passes if it brakes now, itself first.
        ahead: (M, 2) float64: the next metres of its path; none while it has no path.
        claims: where it goes to look.
        doing: whether it may still find work.
        yields: the one with the smaller number goes first; of two that are the same, the one whose name comes
            first.
    """

    name: str
    stamp_s: float
    binding_s: float
    T_map_base: Pose2
    twist: Twist2
    radius_m: float
    speed_limit_mps: float
    stop: NDArray[np.float64]
    ahead: NDArray[np.float64]
    claims: tuple[tuple[float, float], ...] = ()
    doing: Doing = Doing.AT_WORK
    yields: int = 0

    @property
    def right_of_way(self) -> tuple[int, str]:
        """The smaller one goes first."""
        return (self.yields, self.name)

    @property
    def is_parked(self) -> bool:
        """Whether it stands and has nowhere to go."""
        return not len(self.ahead) and self.is_standing

    @property
    def is_standing(self) -> bool:
        """Whether it does not move along."""
        return abs(self.twist.linear_mps) < _STANDS_MPS

    def at(self, time_s: float) -> tuple[float, float]:
        """Where its centre is if it goes on as it did."""
        c, s = np.cos(self.T_map_base.yaw_rad), np.sin(self.T_map_base.yaw_rad)
        way_m = self.twist.linear_mps * (time_s - self.stamp_s)
        return (self.T_map_base.x + float(c) * way_m, self.T_map_base.y + float(s) * way_m)

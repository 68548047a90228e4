"""A path made ready to be followed: legs between sharp bends, each with heading and curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, Pose2, way_along

__all__ = ["SPACING_M", "Leg", "legs_of", "project"]

SPACING_M = 0.02
_CLOSE_M = 0.03  # points nearer than this say nothing about direction
_WINDOW = 7  # samples of the running mean over headings, odd
_BEHIND_M, _AHEAD_M = 0.2, 0.4  # near where the robot was
_HEADING_WEIGHT_M = 0.1
_TURN_RESERVE = 0.85  # share of the angular limits that the path itself may use; feedback has the rest


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A piece of path without sharp bends, sampled every ``spacing_m``.

    Attributes:
        points: (N, 2) float64, metres, ``map`` frame.
        heading_rad: (N,) float64, unwrapped.
        curvature: (N,) float64, 1/m, change of heading along the leg.
        curvature_rate: (N,) float64, 1/m², its change along the leg.
        spacing_m: between samples.
    """

    points: NDArray[np.float64]
    heading_rad: NDArray[np.float64]
    curvature: NDArray[np.float64]
    curvature_rate: NDArray[np.float64]
    spacing_m: float

    @property
    def length_m(self) -> float:
        """Arc length."""
        return (len(self.points) - 1) * self.spacing_m

    def index_at(self, along_m: float) -> int:
        """The last sample not beyond an arc length."""
        return min(max(int(along_m / self.spacing_m), 0), len(self.points) - 1)

    def project_near(self, pose: Pose2, along_m: float) -> tuple[float, float, float, float]:
        """``project_between`` from a little behind an arc length to a little ahead of it."""
        return self.project_between(pose, along_m - _BEHIND_M, along_m + _AHEAD_M)

    def project_between(self, pose: Pose2, low_m: float, high_m: float) -> tuple[float, float, float, float]:
        """The place nearest to a pose between two arc lengths; see ``project``."""
        along, lateral, error, away = project(
            self.points,
            self.heading_rad,
            self.spacing_m,
            pose.x,
            pose.y,
            pose.yaw_rad,
            low_m,
            high_m,
            _HEADING_WEIGHT_M,
        )
        return (along, lateral, error, away)

    def speed_limits(self, limits: MotionLimits, lateral_acceleration_mps2: float) -> NDArray[np.float64]:
        """(N,) float64 m/s: what curvature and its changes allow, sample by sample."""
        bend = np.abs(self.curvature) + 1e-9
        change = np.abs(self.curvature_rate) + 1e-9
        sudden = np.abs(np.gradient(self.curvature_rate, self.spacing_m)) + 1e-9
        return np.minimum.reduce(
            (
                np.full(len(bend), limits.speed_mps),
                _TURN_RESERVE * limits.turn_rate_rps / bend,
                np.sqrt(lateral_acceleration_mps2 / bend),
                np.sqrt(_TURN_RESERVE * limits.turn_acceleration_rps2 / change),
                np.cbrt(_TURN_RESERVE * limits.turn_jerk_rps3 / sudden),
            )
        )


def legs_of(poses: NDArray[np.float64], sharp_bend_rad: float) -> list[Leg]:
    """Cut a path at bends sharper than ``sharp_bend_rad``; empty if it goes nowhere.

    Args:
        poses: (N, 3) float64, see ``Path.poses``.
        sharp_bend_rad: between one piece of the path and the next.
    """
    points = _apart(poses[:, :2])
    if len(points) < 2:
        return []
    steps = np.diff(points, axis=0)
    heading = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    sharp = np.flatnonzero(np.abs(np.diff(heading)) > sharp_bend_rad) + 1
    ends = [0, *sharp.tolist(), len(points) - 1]
    return [_leg(points[a : b + 1]) for a, b in pairwise(ends)]


def _apart(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The points without those too near their predecessor; the last one always stays."""
    kept = [0]
    for i in range(1, len(points)):
        if math.hypot(*(points[i] - points[kept[-1]])) >= _CLOSE_M:
            kept.append(i)
    last = len(points) - 1
    if kept[-1] != last and len(kept) > 1:
        kept[-1] = last
    return points[kept]


def _leg(points: NDArray[np.float64]) -> Leg:
    steps = np.diff(points, axis=0)
    along = way_along(points)
    count = max(2, math.ceil(along[-1] / SPACING_M) + 1)
    wanted = np.linspace(0.0, along[-1], count)
    spacing = along[-1] / (count - 1)
    sampled = np.column_stack(
        (np.interp(wanted, along, points[:, 0]), np.interp(wanted, along, points[:, 1]))
    )
    directions = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    middles = 0.5 * (along[:-1] + along[1:])
    heading = _mean(_mean(_interpolate(wanted, middles, directions)))
    curvature = np.gradient(heading, spacing)
    rate = _mean(np.gradient(curvature, spacing))
    return Leg(sampled, heading, curvature, rate, spacing)


def _interpolate(
    at: NDArray[np.float64], known: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Linear interpolation, carried on at both ends."""
    result = np.interp(at, known, values)
    if len(known) > 1:
        before, after = at < known[0], at > known[-1]
        first = (values[1] - values[0]) / (known[1] - known[0])
        last = (values[-1] - values[-2]) / (known[-1] - known[-2])
        result[before] = values[0] + first * (at[before] - known[0])
        result[after] = values[-1] + last * (at[after] - known[-1])
    return result


def _mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Running mean; odd reflection at the ends keeps a straight line straight."""
    half = _WINDOW // 2
    if len(values) <= half:
        return values
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    sums = np.cumsum(np.concatenate(([0.0], padded)))
    return (sums[_WINDOW:] - sums[:-_WINDOW]) / _WINDOW


@njit(cache=True)
def project(points, heading, spacing, x, y, yaw, low, high, heading_weight):  # type: ignore[no-untyped-def]  # numba kernel
    """The nearest place on a leg between two arc lengths.

    Where the path crosses itself, the branch that runs the robot's way is nearer: ``heading_weight``
    metres are added for a radian of difference.

    Returns:
        Arc length (m), signed lateral offset (m, left is positive), heading error (rad, in [-π, π)), and
        distance from that place (m).
    """
    count = len(points)
    first = min(max(int(low / spacing), 0), count - 2)
    last = min(max(int(high / spacing) + 1, first + 1), count - 1)
    best, best_along = math.inf, first * spacing
    for i in range(first, last):
        ux, uy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        square = ux * ux + uy * uy
        t = ((x - points[i, 0]) * ux + (y - points[i, 1]) * uy) / square if square > 0.0 else 0.0
        t = min(max(t, 0.0), 1.0)
        away = math.hypot(x - points[i, 0] - t * ux, y - points[i, 1] - t * uy)
        turn = (yaw - heading[i] + math.pi) % (2.0 * math.pi) - math.pi
        away += heading_weight * abs(turn)
        if away < best - 1e-12:
            best, best_along = away, (i + t) * spacing
    k = min(int(best_along / spacing), count - 2)
    t = best_along / spacing - k
    at = (1.0 - t) * heading[k] + t * heading[k + 1]
    px = (1.0 - t) * points[k, 0] + t * points[k + 1, 0]
    py = (1.0 - t) * points[k, 1] + t * points[k + 1, 1]
    lateral = -math.sin(at) * (x - px) + math.cos(at) * (y - py)
    turn = (yaw - at + math.pi) % (2.0 * math.pi) - math.pi
    return best_along, lateral, turn, math.hypot(x - px, y - py)

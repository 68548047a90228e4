"""Driving by the cheapest of many sampled motions: model predictive path integral control."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, MotionState, Path
from explore_bt_controllers.driving_law import Place
from explore_bt_controllers.nearby import Nearby
from explore_bt_controllers.noise import NoiseBank
from explore_bt_controllers.options import MppiOptions
from explore_bt_controllers.proposals import propose
from explore_bt_controllers.rollout import Bounds, Field, Prices, Route, Start, costs_of
from explore_bt_controllers.speed_ahead import SpeedAhead
from explore_bt_controllers.track import Leg
from explore_bt_controllers.wish import Wish, next_linear

__all__ = ["SampledLaw"]

_BRAKE_SHARE = (
    0.5  # of the acceleration, for the speed wanted ahead of slow places: a jerky brake averages that
)
_LOYALTY = 0.1  # cost by which another plan must be better than the one pursued
_BROKEN_OFF_S = 0.3  # after a pause as long as this the last plan is of no use
_LOOK_M = 1.5  # along the path, for what hinders


class SampledLaw:
    """Williams et al., "Information theoretic MPC for model-based reinforcement learning", ICRA 2017.

    In each period the last plan, moved on in time, competes with a few proposals; noise is laid around the
    cheapest, and the plan becomes the mean of all samples, weighted by exp(-cost / temperature). Proposals
    beside the mean of the noise are Trevisan and Alonso-Mora's "Biased-MPPI" (RA-L 2024): they find the other
    side of an obstacle, which noise around one plan does not.
    """

    def __init__(
        self, path: Path, options: MppiOptions, footprint_radius_m: float, nearby: Nearby, noise: NoiseBank
    ) -> None:
        self._options = options
        self._footprint_m = footprint_radius_m
        self._nearby = nearby
        self._noise = noise
        self._speeds = SpeedAhead(path, options, footprint_radius_m)
        self._route: tuple[Leg, MotionLimits, Route] | None = None
        self._plan: NDArray[np.float64] | None = None
        self._place: Place | None = None

    def drive(self, place: Place, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        """See ``DrivingLaw.drive``."""
        plan = self._better_plan(self._last_plan(place), place, motion, limits)
        self._plan, self._place = plan, place
        fastest = self._speeds.fastest(place.leg, place.along_m, limits.speed_mps, motion, limits, dt_s)
        linear = min(next_linear(float(plan[0, 0]), motion, limits, dt_s), fastest)
        return Wish(linear, float(plan[1, 0]))

    def hindrance(self) -> str:
        """See ``DrivingLaw.hindrance``."""
        if self._place is None:
            return ""
        leg, along = self._place.leg, self._place.along_m
        first = leg.index_at(along)
        ahead = leg.points[first : leg.index_at(along + _LOOK_M) + 1]
        for x, y, reach, _ in self._moving(np.array([self._place.time_s]))[0]:
            near = np.hypot(ahead[:, 0] - x, ahead[:, 1] - y) < reach
            if near.any():
                return f"waiting for something that moves, on the path {near.argmax() * leg.spacing_m:.1f} m ahead"
        room = _room_at(self._nearby.field(*self._place.pose.xy), ahead)
        near = room < self._least_room(place_leg=leg, along_m=along)
        return (
            f"something stands on the path {near.argmax() * leg.spacing_m:.1f} m ahead" if near.any() else ""
        )

    def _last_plan(self, place: Place) -> NDArray[np.float64] | None:
        """(2, K) the last plan from now on; None if it was for another leg, or is too old."""
        last = self._place
        if self._plan is None or last is None or last.leg is not place.leg:
            return None
        passed_s = place.time_s - last.time_s
        if not 0.0 <= passed_s < _BROKEN_OFF_S:
            return None
        steps = np.arange(self._options.steps)
        then = steps + passed_s / self._options.step_time
        return np.stack([np.interp(then, steps, row) for row in self._plan])

    def _better_plan(
        self,
        last: NDArray[np.float64] | None,
        place: Place,
        motion: MotionState,
        limits: MotionLimits,
    ) -> NDArray[np.float64]:
        options = self._options
        start, bounds = _start_of(place, motion), self._bounds(limits)
        route = self._route_on(place.leg, limits)
        field = self._nearby.field(*place.pose.xy)
        moving = self._moving(place.time_s + options.step_time * np.arange(1, options.steps + 1))
        prices = self._prices(place)
        proposals = propose(
            start, bounds, route, options.step_time, options.steps, options.convergence, options.deviation
        )
        if last is not None:
            proposals = np.concatenate((proposals, last[:, :, None].astype(np.float32)), axis=2)
        nothing = np.zeros((2, options.steps))
        world = (start, bounds, route, field, moving, prices, options.step_time)
        costs = costs_of(*world, nothing, proposals, 0, 0, proposals.shape[2])
        if last is not None:
            costs[-1] -= _LOYALTY
        plan = proposals[:, :, int(costs.argmin())].astype(np.float64)
        first_v, first_w = self._noise.windows()
        costs = costs_of(*world, plan, self._noise.sequences, first_v, first_w, options.samples)
        weights = np.exp((costs.min() - costs) / options.temperature)
        weights = (weights / weights.sum()).astype(np.float32)
        for row, first in enumerate((first_v, first_w)):
            plan[row] += self._noise.sequences[row, :, first : first + options.samples] @ weights
        return plan

    def _route_on(self, leg: Leg, limits: MotionLimits) -> Route:
        if self._route is None or self._route[0] is not leg or self._route[1] is not limits:
            allowed = self._speeds.limits_on(leg, limits)
            speed = _braked(allowed, leg.spacing_m, _BRAKE_SHARE * limits.acceleration_mps2)
            heading = leg.heading_rad
            samples = np.column_stack(
                (leg.points, np.cos(heading), np.sin(heading), leg.curvature, leg.curvature_rate, speed)
            )
            self._route = (leg, limits, Route(samples, leg.spacing_m))
        return self._route[2]

    def _moving(self, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
        options = self._options
        reach_m = self._footprint_m + options.moving_margin
        return self._nearby.moving_at(times_s, reach_m, options.moving_soft_margin, options.moving_doubt)

    def _bounds(self, limits: MotionLimits) -> Bounds:
        return Bounds(
            -min(self._options.reverse_speed, limits.speed_mps),
            limits.speed_mps,
            limits.acceleration_mps2,
            limits.jerk_mps3,
            limits.turn_rate_rps,
            limits.turn_acceleration_rps2,
            limits.turn_jerk_rps3,
        )

    def _least_room(self, place_leg: Leg, along_m: float) -> float:
        """Metres from the centre: what is asked for, or what the path itself leaves where it is tighter."""
        return self._footprint_m + self._options.margin

    def _prices(self, place: Place) -> Prices:
        hard = self._least_room(place.leg, place.along_m)
        return Prices(
            speed=2.0,
            deviation=0.5,
            offset=0.3,
            beyond=20.0,
            heading=0.3,
            acceleration=0.1,
            turn_acceleration=0.02,
            reverse=2.0,
            room=1.0,
            touch=60.0,
            depth=200.0,
            near=2.0,
            widest=self._options.deviation,
            hard=hard,
            soft=max(hard + 0.01, self._footprint_m + self._options.soft_margin),
        )


def _start_of(place: Place, motion: MotionState) -> Start:
    pose, twist = place.pose, motion.twist
    return Start(
        pose.x,
        pose.y,
        pose.yaw_rad,
        twist.linear_mps,
        motion.linear_acceleration_mps2,
        twist.angular_rps,
        motion.angular_acceleration_rps2,
        place.along_m,
    )


def _braked(allowed: NDArray[np.float64], spacing_m: float, gain_mps2: float) -> NDArray[np.float64]:
    """(N,) m/s: speed limits that are kept ahead of slow places too, and that end at rest."""
    way = 2.0 * gain_mps2 * spacing_m * np.arange(len(allowed))
    energy = np.square(allowed) + way
    energy[-1] = way[-1]
    return np.sqrt(np.maximum(np.minimum.accumulate(energy[::-1])[::-1] - way, 0.0))


def _room_at(field: Field, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) metres in the cells of (N, 2) points; those outside the field are taken for its edge."""
    cols = np.rint((points[:, 0] - field.x0) / field.resolution).clip(0, field.room.shape[1] - 1)
    rows = np.rint((points[:, 1] - field.y0) / field.resolution).clip(0, field.room.shape[0] - 1)
    return field.room[rows.astype(np.int64), cols.astype(np.int64)].astype(np.float64)

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
from explore_bt_controllers.rollout import BLOCK, Bounds, Prices, Route, Start, World, costs_of
from explore_bt_controllers.speed_ahead import SpeedAhead
from explore_bt_controllers.track import Leg
from explore_bt_controllers.wish import Wish, next_linear

__all__ = ["SampledLaw"]

_BRAKE_SHARE = 0.5  # of the acceleration, for the speed wanted ahead of slow places: jerk takes the rest
_LOYALTY = 0.1  # by which another plan must be cheaper than the one pursued
_BROKEN_OFF_S = 0.3  # after a pause as long as this the last plan is of no use
_WAITING_MPS = 0.05
_STRAIGHTEN_S = 0.5  # in which who waits turns to the path, at most: faster they would turn past it
_LOOK_M = 1.5  # along the path, for what is tight or in the way
_SQUEEZE_M = 0.02  # nearer than the path's own clearance: the map's cells are as coarse
_LEAST_MARGIN_M = -0.03  # the safety gate has the last word


class SampledLaw:
    """Williams et al., "Information theoretic MPC for model-based reinforcement learning", ICRA 2017.

    In each period the last plan, moved on in time, competes with a few proposals; noise is laid around the
    cheapest, and the plan becomes the mean of all samples, weighted by exp(-cost / temperature). Proposals
    beside the noise are Trevisan and Alonso-Mora's ("Biased-MPPI", RA-L 2024): they find the other side of
    an obstacle, which noise around one plan does not. Their cost of control relative to noise-free motion
    is left out: the plan itself is the base distribution.
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
        world = self._world(place, motion, limits)
        plan = self._improved(self._nominal(place, world), world)
        self._plan, self._place = plan, place
        fastest = self._speeds.fastest(place.leg, place.along_m, limits.speed_mps, motion, limits, dt_s)
        linear = min(next_linear(float(plan[0, 0]), motion, limits, dt_s), fastest)
        return Wish(linear, self._turn_rate(float(plan[1, 0]), linear, place))

    def _turn_rate(self, rate_rps: float, linear_mps: float, place: Place) -> float:
        """Who waits for people turns to the path only: else they dance about the robot, and it with them."""
        waits = abs(linear_mps) < _WAITING_MPS and bool(self._nearby.moving)
        if not waits:
            return rate_rps
        straight_rps = -place.heading_error_rad / _STRAIGHTEN_S
        return min(max(rate_rps, min(straight_rps, 0.0)), max(straight_rps, 0.0))

    def hindrance(self) -> str:
        """See ``DrivingLaw.hindrance``."""
        if self._place is None:
            return ""
        place, leg = self._place, self._place.leg
        first = leg.index_at(place.along_m)
        ahead = leg.points[first : leg.index_at(place.along_m + _LOOK_M) + 1]
        for x, y, reach, _ in self._moving_at(np.array([place.time_s]))[0]:
            near = np.hypot(ahead[:, 0] - x, ahead[:, 1] - y) < reach
            if near.any():
                away_m = near.argmax() * leg.spacing_m
                return f"waiting for something that moves, on the path {away_m:.1f} m ahead"
        near = self._nearby.room_at(ahead, *place.pose.xy) < self._footprint_m + self._margins(place)[0]
        return f"something is on the path {near.argmax() * leg.spacing_m:.1f} m ahead" if near.any() else ""

    def _nominal(self, place: Place, world: World) -> NDArray[np.float64]:
        """(2, K): the plan to lay noise around."""
        options = self._options
        proposals = propose(world, options.steps, options.convergence, options.deviation)
        last = self._last_plan(place)
        if last is not None:
            proposals = np.concatenate((proposals, last[:, :, None].astype(np.float32)), axis=2)
        count = proposals.shape[2]
        block = np.zeros((2, 1, options.steps, BLOCK), dtype=np.float32)
        block[:, 0, :, :count] = proposals
        costs = costs_of(world, np.zeros((2, options.steps)), block, (0, 0), count)
        if last is not None:
            costs[-1] -= _LOYALTY
        return proposals[:, :, costs.argmin()].astype(np.float64)

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

    def _improved(self, plan: NDArray[np.float64], world: World) -> NDArray[np.float64]:
        """(2, K): the plan and the weighted mean of the noise around it."""
        options, runs = self._options, self._noise.runs()
        costs = costs_of(world, plan, self._noise.sequences, runs, options.samples)
        weights = np.exp((costs.min() - costs) / options.temperature)
        better = plan + self._noise.mean(runs, (weights / weights.sum()).astype(np.float32))
        bounds = world.bounds  # what is asked beyond them does nothing, and would have to be taken back first
        better[0] = better[0].clip(bounds.lowest, bounds.highest)
        better[1] = better[1].clip(-bounds.turn_rate, bounds.turn_rate)
        return better

    def _world(self, place: Place, motion: MotionState, limits: MotionLimits) -> World:
        options = self._options
        steps = np.arange(1, options.steps + 1, dtype=np.float64)
        times_s = place.time_s + options.step_time * steps
        return World(
            _start_of(place, motion),
            self._bounds(limits),
            self._route_on(place.leg, limits),
            self._nearby.field(*place.pose.xy),
            self._moving_at(times_s),
            self._prices(place),
            options.step_time,
        )

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

    def _moving_at(self, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
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

    def _margins(self, place: Place) -> tuple[float, float]:
        """Metres beside the footprint, needed and liked: what the path itself leaves where it is tighter."""
        options = self._options
        planned_m = self._speeds.least_room(place.leg, place.along_m, _LOOK_M) - _SQUEEZE_M
        needed_m = min(options.margin, max(planned_m, _LEAST_MARGIN_M))
        return (needed_m, max(min(options.soft_margin, planned_m), needed_m + _SQUEEZE_M))

    def _prices(self, place: Place) -> Prices:
        needed_m, liked_m = self._margins(place)
        return Prices(self._options.deviation, self._footprint_m + needed_m, self._footprint_m + liked_m)


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

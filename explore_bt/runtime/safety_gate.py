"""The safety gate: no command leaves from which a checked stop does not exist.

Before each command the gate rolls the robot forward: the control period under the wanted twist, then
the jerk-limited brake to rest, turning included. Every place on that way must be free for the footprint,
in the last scans and in the newest map, where unknown counts as obstacle. Of things that move it must stay
clear until it is at rest, whichever way they walk; of team mates, where they would stop. If a place is not
free, the brake that was checked the last time goes out instead. So by induction the robot can always stop
in free space, before anyone is there.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.interfaces import HeldBy, Surroundings
from explore_bt.runtime.clearance_window import ClearanceWindow
from explore_bt.runtime.team_mate import fault_by_mates
from explore_bt.runtime.walking_distance import WalkingDistance, spare_of_walkers_m
from explore_bt.runtime.way_to_rest import WayToRest, brake_velocities, way_to_rest
from explore_bt.types import Mate, MotionLimits, MotionState, Pose2, Twist2

__all__ = ["GateDecision", "SafetyGate"]

VOTES = ((1, -0.005), (5, 0.010), (15, 0.010))
"""Scans that vote, and how far beyond the footprint (metres) the median of them must find room.

One scan errs by centimetres, the median of five by one, of fifteen by half of that. Only the newest knows
what has just appeared, but its noise may not stop the robot in every door, so alone it may fall short."""
HASTE_MARGIN_M = 0.02
CRAWL_MPS, FAST_MPS = 0.1, 0.3
"""More for all of them beyond a crawl, all of it when fast, where less time is left to find out."""
MAP_ERROR_M = 0.02
"""By so much a wall may stand before its cells; it counts where the scans cannot say, beside who moves."""
LOOK_AHEAD_M = 1.5
"""How far around the robot map and points are looked at: any stop from 0.8 m/s, plus the footprint."""
INSIDE_SHARE = 0.6
"""Share of the needed clearance below which the robot counts as standing inside an obstacle."""
ESCAPE_SLOPE = 0.1
"""Metres of clearance that a way out of too tight a place must win for every metre driven."""
RESTART_WAY_M = 0.1
"""Free way that the robot needs to set off again where the scans held it: no creeping by lucky draws."""
ONWARD_STEP_M = 0.02
MOST_BEND = 4.0
"""1/m: a robot that bends more sharply is turning on the spot."""
WALKING_MPS = 1.6
"""How fast a moving thing may come, from any side: a brisk walk."""
STARTING_MPS2 = 2.5
"""How quickly it may start, stop or turn."""
AT_REST_MPS = 0.045
"""Below this the robot counts as standing: what walks into it then was not run into."""
MOVING_MARGIN_M = 0.05
SURE_S = 0.3
"""Held by someone at rest, the robot sets off only after so long without them: who is near is easily lost."""
TOUCHED_S = 0.6
"""The same after someone has come up to the robot: nobody is seen who stands against the lidar."""
BODY_M = 0.25
"""Radius of who may stand unseen behind a corner."""
CAUTIOUS_MPS = 0.14
"""So slow the robot goes on, though someone might step out: else it would never pass a door."""
MATE_OFF_M = 0.25
"""Returns so near to a team mate's disc may be its own: of an old word, of what it carries."""
BESIDE_M = 0.15
"""Returns so near to what was seen of a moving thing are its own."""
_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class GateDecision:
    """The motion to send, and why it is not the one that was asked for (empty if it is)."""

    motion: MotionState
    reason: str = ""
    held_by: HeldBy = HeldBy.NOTHING


@dataclass(slots=True)
class _Brake:
    """A checked way to rest: the state it starts from and the time driven along it."""

    start: MotionState
    elapsed_s: float = 0.0


class SafetyGate:
    """Checks commands for one robot and brakes for it when it must.

    Attributes:
        mates: those of its team whose word is fresh.
        in_the_way: the name of the one that it was last held for; empty while it keeps its own word.
        stays_until_s: the team has been told that the robot stays where it is until then.
    """

    def __init__(self, footprint_radius_m: float, limits: MotionLimits, delay_s: float = 0.0) -> None:
        """Guard a robot.

        Args:
            footprint_radius_m: of the robot.
            limits: of the brake; it may be harder than anything the controller does.
            delay_s: so much later than its commands it is where they lead: people walk on meanwhile.
        """
        self.mates: tuple[Mate, ...] = ()
        self.in_the_way = ""
        self.stays_until_s = -math.inf
        self._radius_m = footprint_radius_m
        self._delay_s = delay_s
        self._limits = limits
        self._brake = _Brake(MotionState())
        self._window = ClearanceWindow(LOOK_AHEAD_M)
        self._is_held = False
        self._around: Surroundings | None = None
        self._walkers = np.empty((0, 7))
        self._map_margin_m = 0.0
        self._from_moving: WalkingDistance | None = None
        self._from_hidden: WalkingDistance | None = None
        self._unsure_until_s = -math.inf
        self._scans: deque[NDArray[np.float64]] = deque(maxlen=max(count for count, _ in VOTES))

    def see(self, surroundings: Surroundings, near: Pose2) -> None:
        """Take the newest scan and map.

        Args:
            surroundings: what is around the robot.
            near: where the robot is; the map is looked at around it.
        """
        points = surroundings.points
        self._around = surroundings
        self._walkers = _walkers(surroundings)
        for thing in surroundings.moving:  # it is kept clear of by itself, and will not be there for ever
            points = points[np.hypot(*(points - thing.xy).T) > thing.radius_m + BESIDE_M]
        is_near = np.hypot(points[:, 0] - near.x, points[:, 1] - near.y) < LOOK_AHEAD_M
        self._scans.append(np.ascontiguousarray(points[is_near]))
        self._map_margin_m = MAP_ERROR_M if len(points) < len(surroundings.points) else 0.0
        self._window.cut(surroundings.grid, near, points)  # the map answers for the wall beside whoever moves
        self._from_moving = _walking_from_moving(surroundings, near)
        self._from_hidden = _walking_from_hidden(surroundings, near)

    def forget_scans(self) -> None:
        """The scans seen so far no longer lie where the pose says: a loop closure moved it."""
        self._scans.clear()

    def decide(
        self,
        wanted: Twist2,
        pose: Pose2,
        motion: MotionState,
        dt_s: float,
        now_s: float = 0.0,
        in_force_s: float = 0.0,
    ) -> GateDecision:
        """Pass ``wanted`` on, or go on along the brake that was checked last.

        Args:
            wanted: the controller's twist for the coming period.
            pose: the robot's pose now, ``map`` frame.
            motion: what was sent last.
            dt_s: the control period.
            now_s: the time, on the clock of the scans' stamps.
            in_force_s: the command may drive for so long before the next one, if that is more than ``dt_s``.
        """
        following = _state_after(self._let_go_of_brake(wanted, motion, dt_s), motion, dt_s)
        before = following if in_force_s > dt_s else motion
        way = way_to_rest(following, pose, before, self._limits, max(in_force_s, dt_s))
        # a disc turning on the spot touches nothing that it does not touch already
        moves_off = bool(np.any(way.poses[:, :2] - way.poses[0, :2]))
        fault, whom = self._fault_on_the_way(way, following) if moves_off else ("", "")
        held_by = HeldBy.MATE if whom else HeldBy.OBSTACLE
        if not fault:
            held_by, fault = HeldBy.SOMEONE, self._fault_by_people(way, now_s)
        if not fault and moves_off:
            held_by, (fault, whom) = HeldBy.MATE, fault_by_mates(way.poses, self._radius_m, self.mates, now_s)
        self.in_the_way = whom or self.in_the_way
        if not fault and moves_off and now_s < self.stays_until_s:
            held_by, fault, self.in_the_way = HeldBy.MATE, "the team has been told that it stays here", ""
        if fault:
            return GateDecision(self._next_of_brake(motion, dt_s), fault, held_by)
        self._brake = _Brake(following)
        return GateDecision(following)

    def stop_places(self, motion: MotionState, pose: Pose2, dt_s: float) -> NDArray[np.float64]:
        """(N, 2) metres, ``map`` frame: where the robot passes if it brakes after the coming period."""
        return way_to_rest(motion, pose, motion, self._limits, dt_s).poses[:, :2]

    def _let_go_of_brake(self, wanted: Twist2, motion: MotionState, dt_s: float) -> Twist2:
        """A brake harder than the controller ever drives ends under its own jerk, before that one goes on."""
        change = self._limits.jerk_mps3 * dt_s
        wished = (wanted.linear_mps - motion.twist.linear_mps) / dt_s
        before = motion.linear_acceleration_mps2
        if abs(wished - before) <= change + _ROUNDING:
            return wanted
        slope = min(max(wished, before - change), before + change)
        return replace(wanted, linear_mps=motion.twist.linear_mps + slope * dt_s)

    def brake(self, motion: MotionState, dt_s: float) -> MotionState:
        """The next state of a controlled stop, whatever the controller wants."""
        return self._next_of_brake(motion, dt_s)

    def _next_of_brake(self, motion: MotionState, dt_s: float) -> MotionState:
        brake = self._brake
        brake.elapsed_s += dt_s
        times = np.array([brake.elapsed_s])
        linear, angular = brake_velocities(brake.start, self._limits, times)
        return _state_after(Twist2(float(linear[0]), float(angular[0])), motion, dt_s)

    def _fault_on_the_way(self, way: WayToRest, following: MotionState) -> tuple[str, str]:
        """What is too near to the way, and which team mate that is; empty where it is none."""
        ahead = way.poses
        on_grid = self._window.clearance_m(ahead[:, :2], between_cells=self._map_margin_m > 0.0)
        needed_m = self._radius_m + self._map_margin_m
        in_map = _shortfall(on_grid, needed_m, "obstacle or unknown space in the map")
        return (in_map, "") if in_map else self._fault_in_scans(ahead, following)

    def _fault_by_people(self, way: WayToRest, now_s: float) -> str:
        if self._around is None:
            return ""
        fault = self._fault_by_moving(way, now_s, self._around)
        fault = fault or self._fault_by_hidden(way, now_s, self._around)
        if fault:
            self._unsure_until_s = max(self._unsure_until_s, now_s + SURE_S)
        elif now_s < self._unsure_until_s and way.speeds_mps[0] < AT_REST_MPS < way.speeds_mps.max():
            fault = "someone was near a moment ago"
        return fault

    def _fault_by_moving(self, way: WayToRest, now_s: float, around: Surroundings) -> str:
        if self._from_moving is None:
            return ""
        away_m = self._from_moving.to(way.poses[:, :2]) - self._radius_m
        if away_m[0] < 0.0:
            self._unsure_until_s = now_s + TOUCHED_S
        moving = _until(way.speeds_mps, AT_REST_MPS)
        times_s = now_s + self._delay_s + way.times_s[moving]
        spare_m = np.maximum(
            away_m[moving] - WALKING_MPS * (times_s - around.stamp_s),
            self._spare_in_the_open_m(way.poses[moving, :2], times_s),
        )
        if (spare_m.size and spare_m.min() < MOVING_MARGIN_M) or away_m[-1] < min(away_m[0], MOVING_MARGIN_M):
            return f"someone {max(away_m[0], 0.0):.1f} m away could be met before the robot stands"
        return ""

    def _spare_in_the_open_m(
        self, places: NDArray[np.float64], times_s: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        spare_m = spare_of_walkers_m(places, times_s, self._walkers, WALKING_MPS, STARTING_MPS2)
        return spare_m - self._radius_m

    def _fault_by_hidden(self, way: WayToRest, now_s: float, around: Surroundings) -> str:
        fast = _until(way.speeds_mps, CAUTIOUS_MPS)
        ahead = way.poses[fast, :2]
        if not len(ahead) or self._from_hidden is None:
            return ""
        away_m = self._from_hidden.to(ahead) - self._radius_m
        walked_m = WALKING_MPS * (now_s + self._delay_s + way.times_s[fast] - around.stamp_s)
        if (away_m - walked_m).min() >= 0.0:
            return ""
        return "someone may step out before the robot is slow"

    def _fault_in_scans(self, ahead: NDArray[np.float64], following: MotionState) -> tuple[str, str]:
        if self._is_held:
            ahead = np.vstack([ahead, _onward(ahead[-1], following.twist, RESTART_WAY_M)])
        speed_mps = abs(following.twist.linear_mps)
        fault = _shortfall_in_scans(ahead[:, :2], self._scans, self._radius_m, speed_mps)
        self._is_held = bool(fault)
        return fault, self._mate_in_scans(ahead[:, :2], speed_mps) if fault else ""

    def _mate_in_scans(self, ahead: NDArray[np.float64], speed_mps: float) -> str:
        """The team mate whose returns alone are too near: its word is not exact enough to cut all of them."""
        for mate in self.mates:
            reach_m = mate.radius_m + MATE_OFF_M
            scans = [points[np.hypot(*(points - mate.T_map_base.xy).T) > reach_m] for points in self._scans]
            if not _shortfall_in_scans(ahead, scans, self._radius_m, speed_mps):
                return mate.name
        return ""


def _walkers(around: Surroundings) -> NDArray[np.float64]:
    """(K, 7) as ``spare_of_walkers_m`` takes those who move."""
    rows = [
        (*thing.xy, *thing.velocity_mps, thing.radius_m, thing.stamp_s, thing.velocity_off_mps)
        for thing in around.moving
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)


def _walking_from_moving(around: Surroundings, near: Pose2) -> WalkingDistance | None:
    """From everyone who moves, and wherever those seen a moment ago may be by now."""
    if not around.moving:
        return None
    walked_m = [WALKING_MPS * max(around.stamp_s - thing.stamp_s, 0.0) for thing in around.moving]
    radii_m = np.array([thing.radius_m for thing in around.moving]) + walked_m
    return WalkingDistance(around.grid, near, np.array([thing.xy for thing in around.moving]), radii_m)


def _walking_from_hidden(around: Surroundings, near: Pose2) -> WalkingDistance | None:
    if not len(around.hidden):
        return None
    return WalkingDistance(around.grid, near, around.hidden, np.full(len(around.hidden), BODY_M))


def _shortfall_in_scans(
    ahead: NDArray[np.float64], scans: Sequence[NDArray[np.float64]], radius_m: float, speed_mps: float
) -> str:
    """Why (N, 2) places must not be passed at that speed; scans: (K, 2) points each, the newest last."""
    if not scans:
        return ""
    by_scan = np.stack([_nearest_point_m(ahead, points) for points in reversed(scans)])
    needed_m = radius_m + _haste(speed_mps) * HASTE_MARGIN_M
    # a way out must win clearance: were "no closer" enough, noise would let the robot creep closer
    gain_m = ESCAPE_SLOPE * float(np.hypot(*(ahead[-1] - ahead[0])))
    for count, margin_m in reversed(VOTES):
        room_m = np.median(by_scan[:count], axis=0)
        obstacle = f"obstacle in the last {count} scans" if count > 1 else "obstacle in the newest scan"
        if fault := _shortfall(room_m, needed_m + margin_m, obstacle, gain_m if count > 1 else 0.0):
            return fault
    return ""


def _shortfall(clearance_m: NDArray[np.float64], needed_m: float, obstacle: str, gain_m: float = 0.0) -> str:
    """Why a way with these clearances, the first of them here and now, must not be driven.

    Where it is already tighter than needed the way may lead out (``gain_m`` is how much clearer it must end
    than it begins), never closer; where the robot seems to stand inside an obstacle nothing can be told,
    and it stays.
    """
    here, worst = float(clearance_m[0]), float(clearance_m.min())
    if worst >= needed_m:
        return ""
    if here < INSIDE_SHARE * needed_m:
        return f"the robot seems to stand {here:.3f} m from an {obstacle}, needs {needed_m:.3f} m"
    if worst < min(needed_m, here) or (here < needed_m and clearance_m[-1] < here + gain_m):
        return f"the stop would end {worst:.3f} m from an {obstacle}, needs {needed_m:.3f} m"
    return ""


def _until(speeds_mps: NDArray[np.float64], slow_mps: float) -> slice:
    """The samples of a way up to the first from which on it is slow; none if it is slow throughout."""
    fast = np.flatnonzero(speeds_mps > slow_mps)
    return slice(0, int(fast[-1]) + 2 if fast.size else 0)


def _haste(speed_mps: float) -> float:
    """0 at a crawl, 1 when fast."""
    return min(max((speed_mps - CRAWL_MPS) / (FAST_MPS - CRAWL_MPS), 0.0), 1.0)


def _onward(end: NDArray[np.float64], twist: Twist2, length_m: float) -> NDArray[np.float64]:
    """(N, 3) poses every 2 cm for ``length_m`` beyond ``end``, along the twist's arc."""
    v, w = twist.linear_mps, twist.angular_rps
    bend = float(np.clip(w / v, -MOST_BEND, MOST_BEND)) if abs(v) > 1e-3 else 0.0
    x, y, yaw = end
    step_m = math.copysign(ONWARD_STEP_M, v)
    out = []
    for _ in range(round(length_m / ONWARD_STEP_M)):
        middle = yaw + 0.5 * bend * step_m
        x, y, yaw = x + step_m * math.cos(middle), y + step_m * math.sin(middle), yaw + bend * step_m
        out.append((x, y, yaw))
    return np.array(out)


def _state_after(twist: Twist2, motion: MotionState, dt_s: float) -> MotionState:
    return MotionState(
        twist,
        (twist.linear_mps - motion.twist.linear_mps) / dt_s,
        (twist.angular_rps - motion.twist.angular_rps) / dt_s,
    )


@njit(cache=True)
def _nearest_point_m(positions: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    out = np.full(positions.shape[0], np.inf)
    for i in range(positions.shape[0]):
        for k in range(points.shape[0]):
            dx = positions[i, 0] - points[k, 0]
            dy = positions[i, 1] - points[k, 1]
            out[i] = min(out[i], dx * dx + dy * dy)
        out[i] = np.sqrt(out[i])
    return out

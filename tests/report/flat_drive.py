"""A plausible drive through a furnished 10 × 9 m flat, for tests of observers: no SLAM, no planner."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path as FilePath

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Event, HeldBy, NodeInfo, NodeState, RobotSnapshot, RunInfo, TickSnapshot
from explore_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Budget,
    Drawing,
    Estimate,
    FrontierMark,
    HalfPlaneMark,
    Health,
    Imu,
    Measurement,
    MotionState,
    MovingObstacle,
    OccupancyGrid,
    Outcome,
    Path,
    Pose2,
    Result,
    Scan2D,
    Score,
    SectorMark,
    Twist2,
    Verdict,
    ViewMark,
    Waypoint,
    WheelOdometry,
)

RESOLUTION_M = 0.05
MARGIN_M = 0.5
TICK_S = 0.1
BOXES = (
    *((0, 0, 10, 0.1), (0, 8.9, 10, 9), (0, 0, 0.1, 9), (9.9, 0, 10, 9)),  # outer walls
    *((0, 3.95, 1.8, 4.05), (2.7, 3.95, 7.0, 4.05), (7.9, 3.95, 10, 4.05)),  # south of the corridor
    *((0, 5.15, 1.2, 5.25), (2.1, 5.15, 4.6, 5.25), (5.5, 5.15, 7.8, 5.25), (8.7, 5.15, 10, 5.25)),
    *((5.55, 0, 5.65, 1.2), (5.55, 2.3, 5.65, 4), (3.55, 5.2, 3.65, 9), (6.35, 5.2, 6.45, 9)),
    *((0.5, 0.3, 2.3, 1.0), (3.3, 2.0, 4.2, 2.7), (6.2, 0.1, 9.9, 0.7), (0.2, 6.8, 1.9, 8.8)),  # furniture
    *((8.0, 7.0, 9.8, 8.8), (3.8, 8.2, 6.2, 8.9), (2.9, 5.4, 3.5, 6.8), (9.3, 2.6, 9.9, 3.6)),
)
ROUTE = (
    *((1.0, 3.0), (2.3, 3.2), (2.8, 1.6), (4.7, 1.2), (4.8, 3.2), (4.8, 1.75), (6.2, 1.75), (7.4, 1.6)),
    *((8.9, 1.6), (8.7, 3.1), (7.45, 3.0), (7.45, 4.6), (9.3, 4.6), (8.25, 4.6), (8.25, 6.2), (7.2, 6.4)),
    *((7.2, 8.2), (7.2, 6.4), (8.25, 6.1), (8.25, 4.6), (5.05, 4.6), (5.05, 7.4), (5.05, 4.6), (1.65, 4.6)),
    *((1.65, 6.0), (2.5, 7.3), (2.6, 8.3), (2.5, 7.3), (1.65, 6.0), (1.65, 4.6), (0.7, 4.6), (2.25, 4.6)),
    *((2.25, 3.4), (1.0, 3.0)),
)
NODES = (
    ("complete", "sequence", None),
    ("complete/explore", "fallback", 0),
    ("complete/explore/step", "sequence", 1),
    ("complete/explore/step/sense", "sequence", 2),
    ("complete/explore/step/sense/wait_for_map", "wait_for_map", 3),
    ("complete/explore/step/sense/still_ok", "slam_ok", 3),
    ("complete/explore/step/choose", "fallback", 2),
    ("complete/explore/step/choose/find_next_heading", "find_next_heading", 6),
    ("complete/explore/step/choose/again", "sequence", 6),
    ("complete/explore/step/choose/again/reset_half_planes", "reset_half_planes", 8),
    ("complete/explore/step/choose/again/find_any_heading", "find_next_heading", 8),
    ("complete/explore/step/choose/turn_round", "turn_round", 6),
    ("complete/explore/step/drive", "sequence", 2),
    ("complete/explore/step/drive/plan_path", "plan_path", 12),
    ("complete/explore/step/drive/drive_to", "drive_to", 12),
    ("complete/explore/backtrack", "sequence", 1),
    ("complete/explore/backtrack/find_frontier", "find_frontier", 15),
    ("complete/explore/backtrack/drive_back", "drive_to", 15),
    ("complete/go_home", "sequence", 0),
    ("complete/go_home/plan_home", "plan_path", 18),
    ("complete/go_home/drive_home", "drive_to", 18),
    ("complete/done", "succeed", 0),
)
DRIVE, CHOOSE, HOME = 14, 7, 20


@dataclass(frozen=True)
class Drive:
    """A finished drive, ready to be shown to sinks."""

    run: RunInfo
    ticks: list[TickSnapshot]
    events: list[Event]
    result: Result

    def show_to(self, *sinks) -> None:
        for sink in sinks:
            sink.open(self.run)
        pending = list(self.events)
        for tick in self.ticks:
            while pending and pending[0].stamp_s <= tick.stamp_s:
                for sink in sinks:
                    sink.on_event(pending[0])
                pending.pop(0)
            for sink in sinks:
                sink.on_tick(tick)
        for sink in sinks:
            sink.close(self.result)

    def in_folder(self, folder: FilePath) -> Drive:
        return replace(self, run=replace(self.run, folder=folder))


def true_cells() -> NDArray[np.int8]:
    shape = (round((9 + 2 * MARGIN_M) / RESOLUTION_M), round((10 + 2 * MARGIN_M) / RESOLUTION_M))
    cells = np.full(shape, UNKNOWN, dtype=np.int8)
    index = lambda metres: round((metres + MARGIN_M) / RESOLUTION_M)  # noqa: E731 - a local shorthand
    cells[index(0) : index(9), index(0) : index(10)] = FREE
    for x0, y0, x1, y1 in BOXES:
        cells[index(y0) : index(y1), index(x0) : index(x1)] = OCCUPIED
    return cells


def poses_along(route, speed_mps: float) -> NDArray[np.float64]:
    corners = np.array(route)
    lengths = np.concatenate(([0.0], np.hypot(*np.diff(corners, axis=0).T).cumsum()))
    s = np.arange(0.0, lengths[-1], speed_mps * TICK_S)
    xy = np.column_stack([np.interp(s, lengths, corners[:, axis]) for axis in (0, 1)])
    width = max(3, round(0.5 / (speed_mps * TICK_S)) | 1)
    padded = np.pad(xy, ((width // 2, width // 2), (0, 0)), mode="edge")
    xy = np.column_stack([np.convolve(padded[:, axis], np.ones(width) / width, "valid") for axis in (0, 1)])
    step = np.gradient(xy, axis=0)
    return np.column_stack((xy, np.arctan2(step[:, 1], step[:, 0])))


class World:
    """Casts rays through the flat and uncovers a map."""

    def __init__(self) -> None:
        self.cells = true_cells()
        self.known = np.full_like(self.cells, UNKNOWN)
        free = (self.cells == FREE).astype(np.uint8)
        self.clearance_m = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * RESOLUTION_M
        self.floor = int(free.sum())
        self.angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
        self.steps = np.arange(0.05, 5.0, 0.03)
        self.rng = np.random.default_rng(0)

    def index(self, xy):
        return tuple(
            np.floor((np.asarray(xy)[..., axis] + MARGIN_M) / RESOLUTION_M).astype(int) for axis in (1, 0)
        )

    def scan(self, pose, stamp_s: float) -> Scan2D:
        directions = np.column_stack((np.cos(self.angles + pose[2]), np.sin(self.angles + pose[2])))
        points = pose[:2] + directions[:, None, :] * self.steps[None, :, None]
        rows, cols = self.index(points)
        values = self.cells[rows.clip(0, self.cells.shape[0] - 1), cols.clip(0, self.cells.shape[1] - 1)]
        blocked = values != FREE
        hit = blocked.any(axis=1)
        first = np.where(hit, blocked.argmax(axis=1), len(self.steps) - 1)
        before = np.arange(len(self.steps))[None, :] < first[:, None]
        self.known[rows[before], cols[before]] = FREE
        ends = (rows[hit, first[hit]], cols[hit, first[hit]])
        self.known[ends] = OCCUPIED
        ranges = np.where(hit, self.steps[first] + self.rng.normal(0, 0.01, len(first)), np.inf)
        ranges[self.rng.random(len(ranges)) < 0.01] = np.nan
        return Scan2D(stamp_s, self.angles, ranges.astype(np.float32), np.zeros(360), 0.05, 5.0)


def node_infos(robot: str) -> tuple[NodeInfo, ...]:
    return tuple(
        NodeInfo(i, path, path.rsplit("/", 1)[-1], kind, parent, f"missions/01_apartment.yaml:{20 + i}:5")
        for i, (path, kind, parent) in enumerate(NODES)
    )


def ancestors(index: int) -> set[int]:
    parent = NODES[index][2]
    return {index} | (ancestors(parent) if parent is not None else set())


def states(active: int, message: str, choice: str) -> tuple[NodeState, ...]:
    running = ancestors(active)
    return tuple(
        NodeState("running", message if i == active else "", ticks=1)
        if i in running
        else NodeState("success", choice if i == CHOOSE else "", ticks=1, successes=1)
        if i < active
        and NODES[i][1] in ("find_next_heading", "plan_path", "slam_ok", "wait_for_map")
        and i <= 13
        else NodeState("idle", "")
        for i in range(len(NODES))
    )


def drawing_at(here: Pose2, goal: Pose2) -> Drawing:
    """Two sectors, the first refused, a half-plane, a frontier and a view at the goal."""
    yaw = here.yaw_rad
    return Drawing(
        sectors=(
            SectorMark(here.x, here.y, yaw + 0.3, yaw + 1.4, 1.2, Verdict.REJECTED, "visited"),
            SectorMark(here.x, here.y, yaw - 0.4, yaw + 0.3, 1.2, Verdict.TAKEN, "→ the goal"),
        ),
        half_planes=(HalfPlaneMark(here.x, here.y, math.cos(yaw), math.sin(yaw)),),
        frontiers=(FrontierMark(goal.x, goal.y, 1.25),),
        views=(ViewMark(goal.x, goal.y, goal.yaw_rad, 2.5, Verdict.TAKEN, "the next goal"),),
    )


class _Robot:
    def __init__(self, name: str, route, speed_mps: float, world: World) -> None:
        self.name, self.world = name, world
        self.poses = poses_along(route, speed_mps)
        self.speed_mps = speed_mps
        self.visited: tuple[Waypoint, ...] = ()
        self.distance = 0.0
        self.clearances: list[float] = []
        self.grid = OccupancyGrid(world.known.copy(), RESOLUTION_M, (-MARGIN_M, -MARGIN_M), 0)
        self.scan = world.scan(self.poses[0], 0.0)
        self.path: Path | None = None
        self.drawing = Drawing()
        self.choice, self.goal = "", Waypoint(Pose2(*map(float, self.poses[0])))

    def tick(self, index: int, map_every: int) -> RobotSnapshot:
        last = len(self.poses) - 1
        pose = self.poses[min(index, last)]
        stamp_s = index * TICK_S
        leg = round(1.5 / (self.speed_mps * TICK_S))
        if index % leg == 0 and index <= last:
            self._choose(index, min(index + leg, last))
        if index % 5 == 0:
            self.scan = self.world.scan(pose, stamp_s)
        if index % map_every == 0:
            self.grid = OccupancyGrid(self.world.known.copy(), RESOLUTION_M, self.grid.origin_xy, index + 1)
        self.distance += float(np.hypot(*(self.poses[min(index + 1, last)] - pose)[:2]))
        clearance = float(self.world.clearance_m[self.world.index(pose[None, :2])][0])
        self.clearances.append(clearance)
        left_m = max(0.0, self.speed_mps * TICK_S * (leg - index % leg))
        active = HOME if index > 0.9 * last else DRIVE
        message = f"{left_m:.2f} m to go, {self.speed_mps:.2f} m/s"
        braking = "clearance ahead 0.27 m, braking from 0.40 m/s" if 300 <= index < 309 else ""
        noise = 0.01 * np.sin(np.array([0.37, 0.53, 0.11]) * index)
        return RobotSnapshot(
            robot=self.name,
            estimate=Estimate(stamp_s, Pose2(*map(float, pose + noise)), health=Health.OK),
            grid=self.grid,
            scan=self.scan,
            path=self.path,
            motion=MotionState(Twist2(0.0 if index > last else self.speed_mps, 0.1 * math.sin(index / 9))),
            gate_reason=braking,
            nodes=states(active, message, self.choice),
            blackboard={"goal": self.goal, "visited": self.visited, "left_m": left_m, "path": self.path},
            score=self._score(clearance, pose),
            true_pose=Pose2(*map(float, pose)),
            measured=self._measured(stamp_s),
            drawing=self.drawing,
            moving=(MovingObstacle(7, (1.0, 0.1 * (index % 20)), (0.0, 1.0), 0.2, stamp_s),) * (index < 40),
            budgets=(Budget("time", "s", 900.0, 900.0 - stamp_s),),
            charge=1.0 - stamp_s / 3600.0,
            held_by=HeldBy.OBSTACLE if braking else HeldBy.NOTHING,
            claims=() if self.goal is None else (self.goal.position,),
        )

    def _measured(self, stamp_s: float) -> tuple[Measurement, ...]:
        """Ten samples of an IMU, one of the wheels, the scan."""
        imus = [Imu(stamp_s - 0.01 * k, (0.0, 0.0, 0.1), (0.0, 0.0, 9.81)) for k in range(9, -1, -1)]
        return (*imus, WheelOdometry(stamp_s, Pose2(self.distance, 0.0, 0.0)), self.scan)

    def _choose(self, index: int, end: int) -> None:
        goal = Pose2(*map(float, self.poses[end]))
        self.choice = f"3 sectors, widest 62° rejected (visited), took 41° → ({goal.x:.1f}, {goal.y:.1f})"
        self.goal = Waypoint(goal, self.choice, 2.5)
        self.visited = (*self.visited, Waypoint(Pose2(*map(float, self.poses[index])), self.choice, 2.5))
        self.drawing = drawing_at(Pose2(*map(float, self.poses[index])), goal)
        ahead = self.poses[index : end + 1 : max(1, (end - index) // 20)]
        self.path = Path(ahead, np.full(len(ahead), 0.4))

    def _score(self, clearance: float, pose) -> Score:
        mapped = float(((self.grid.cells == FREE) & (self.world.cells == FREE)).sum() / self.world.floor)
        home = float(np.hypot(*(pose - self.poses[0])[:2]))
        mean = sum(self.clearances) / len(self.clearances)
        return Score(self.distance, mapped, 0, clearance, min(self.clearances), mean, 0.021, home)


def _ticks(robots: list[_Robot], count: int, map_every: int) -> Iterator[TickSnapshot]:
    for index in range(count):
        yield TickSnapshot(index, index * TICK_S, tuple(robot.tick(index, map_every) for robot in robots))


def make_drive(
    folder: FilePath, speed_mps: float = 0.4, robots: tuple[str, ...] = ("robot",), map_every: int = 10
) -> Drive:
    """Drive through the flat; 0.4 m/s takes about two and a half minutes, 0.1 m/s ten."""
    world = World()
    routes = (ROUTE, ROUTE[::-1], ROUTE[10:] + ROUTE[:10])
    fleet = [_Robot(name, routes[i % 3], speed_mps, world) for i, name in enumerate(robots)]
    ticks = list(_ticks(fleet, max(len(robot.poses) for robot in fleet) + 5, map_every))
    run = RunInfo(
        mission="01_apartment",
        mission_text="format: explore-bt/1\n# Wohnung <Erdgeschoß>\n",
        mission_sha256="ab" * 32,
        seed=3,
        version="0.1.0",
        folder=folder,
        trees={name: node_infos(name) for name in robots},
        footprint_radius_m=dict.fromkeys(robots, 0.25),
    )
    events = [
        Event(0.0, robots[0], "info", "mission", "first map after 0.0 s"),
        Event(30.0, robots[0], "warning", "gate", "clearance ahead 0.27 m, braking from 0.40 m/s"),
        Event(61.2, robots[0], "info", "slam", "loop closed: 41 keyframes, 3 cm, 0.4°"),
        Event(83.0, robots[0], "warning", "slam", "degraded: few returns in <corridor> & beyond"),
        Event(90.5, robots[0], "error", "plan_path", "no_path: no passage wider than 0.50 m to (9.6, 0.9)"),
    ]
    last = ticks[-1].robots[0].score
    result = Result(
        outcome=Outcome.EXPLORED,
        reason="no reachable frontier wider than 0.50 m is left; returned home",
        mission="01_apartment",
        coverage=last.coverage,
        contacts=0,
        ate_rmse_m=0.021,
        path_length_m=last.distance_m,
        mission_time_s=ticks[-1].stamp_s,
        wall_time_s=41.7,
        min_clearance_m=last.min_clearance_m,
        mean_clearance_m=last.mean_clearance_m,
        distance_to_home_m=last.distance_to_home_m,
        seed=3,
        mission_sha256="ab" * 32,
        version="0.1.0",
        left_open=("frontier of 0.3 m at (9.6, 0.9): behind the counter, no passage wider than 0.50 m",),
        slam={"keyframes": 128.0, "loop_closures": 17.0, "ms_per_scan_median": 2.31, "graph_error_m": 0.004},
    )
    return Drive(run, ticks, [event for event in events if event.stamp_s <= ticks[-1].stamp_s], result)

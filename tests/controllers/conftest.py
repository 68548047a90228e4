"""A room with posts and people in it, driven through with the safety gate between controller and body."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from explore_bt.interfaces import Controller, ControlOutput, ControlStatus, RobotContext, Surroundings
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.testing.controller_contract import KinematicRobot
from explore_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Estimate,
    MotionLimits,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
)

RADIUS = 0.25
CELL = 0.05
DT = 0.05
LIMITS = MotionLimits()


@dataclass(frozen=True)
class Disc:
    """A post, or a person walking straight on; radius in metres, velocity in m/s."""

    x: float
    y: float
    radius: float
    vx: float = 0.0
    vy: float = 0.0

    def at(self, time_s: float) -> tuple[float, float]:
        return (self.x + time_s * self.vx, self.y + time_s * self.vy)

    def outline(self, time_s: float) -> np.ndarray:
        angle = np.linspace(-math.pi, math.pi, 60, endpoint=False)
        return np.array(self.at(time_s)) + self.radius * np.column_stack((np.cos(angle), np.sin(angle)))

    def gap_m(self, pose: Pose2, time_s: float) -> float:
        x, y = self.at(time_s)
        return math.hypot(pose.x - x, pose.y - y) - self.radius - RADIUS


@dataclass(frozen=True)
class Room:
    """Known free floor between walls that are on the map; unknown beyond. Metres."""

    low: tuple[float, float]
    high: tuple[float, float]
    posts: tuple[Disc, ...] = ()
    people: tuple[Disc, ...] = ()

    def grid(self) -> OccupancyGrid:
        border = 10
        cols, rows = (round((b - a) / CELL) for a, b in zip(self.low, self.high, strict=True))
        cells = np.full((rows + 2 * border, cols + 2 * border), UNKNOWN, dtype=np.int8)
        cells[border - 1 : 1 - border, border - 1 : 1 - border] = OCCUPIED
        cells[border:-border, border:-border] = FREE
        return OccupancyGrid(cells, CELL, (self.low[0] - border * CELL, self.low[1] - border * CELL))

    def walls(self) -> np.ndarray:
        (x0, y0), (x1, y1) = self.low, self.high
        along_x, along_y = np.arange(x0, x1, 0.02), np.arange(y0, y1, 0.02)
        sides = [np.column_stack((along_x, np.full(along_x.size, y))) for y in (y0, y1)]
        sides += [np.column_stack((np.full(along_y.size, x), along_y)) for x in (x0, x1)]
        return np.vstack(sides)

    def gap_m(self, pose: Pose2) -> float:
        """From the robot's edge to the nearest wall or post."""
        sides = (pose.x - self.low[0], self.high[0] - pose.x, pose.y - self.low[1], self.high[1] - pose.y)
        return min(min(sides) - RADIUS, *(post.gap_m(pose, 0.0) for post in self.posts), math.inf)


@dataclass
class Episode:
    """What happened: gaps in metres from edge to edge, speeds in m/s."""

    robot: KinematicRobot
    output: ControlOutput
    least_gap_m: float = math.inf
    least_gap_to_people_m: float = math.inf
    fastest_contact_mps: float = 0.0
    braked: int = 0


def drive(controller: Controller, room: Room, path: Path, seconds: float = 60.0, start: Pose2 | None = None):
    """One path, the gate in between, a scan every other period; ends when the controller has done."""
    controller.setup(RobotContext(limits=LIMITS, footprint_radius_m=RADIUS))
    gate, grid, walls = SafetyGate(RADIUS, LIMITS), room.grid(), room.walls()
    robot = KinematicRobot(start or Pose2(*path.poses[0]))
    controller.follow(path)
    episode = None
    for k in range(round(seconds / DT)):
        now = robot.time_s
        if k % 2 == 0:
            outlines = [disc.outline(now) for disc in (*room.posts, *room.people)]
            moving = tuple(
                MovingObstacle(number, person.at(now), (person.vx, person.vy), person.radius, now)
                for number, person in enumerate(room.people)
            )
            surroundings = Surroundings(now, np.vstack([walls, *outlines]), grid, moving)
            gate.see(surroundings, robot.pose)
            controller.see(surroundings)
        output = controller.step(Estimate(now, robot.pose), None, robot.motion, DT)
        decision = gate.decide(output.twist, robot.pose, robot.motion, DT)
        robot.drive(decision.motion.twist, DT)
        episode = episode or Episode(robot, output)
        episode.output = output
        episode.braked += bool(decision.reason)
        _watch(episode, room)
        if output.status is not ControlStatus.RUNNING:
            break
    return episode


def _watch(episode: Episode, room: Room) -> None:
    robot = episode.robot
    episode.least_gap_m = min(episode.least_gap_m, room.gap_m(robot.pose))
    for person in room.people:
        gap = person.gap_m(robot.pose, robot.time_s)
        episode.least_gap_to_people_m = min(episode.least_gap_to_people_m, gap)
        if gap < 0.0:
            speed = abs(robot.motion.twist.linear_mps)
            episode.fastest_contact_mps = max(episode.fastest_contact_mps, speed)


@pytest.fixture(name="drive")
def _drive():
    return drive


@pytest.fixture(name="disc")
def _disc():
    return Disc


@pytest.fixture(name="room")
def _room():
    return Room

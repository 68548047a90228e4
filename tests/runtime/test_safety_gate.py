import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import Surroundings
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, MotionState, OccupancyGrid, Pose2, Twist2

from .conftest import DT, LIMITS, towards

RADIUS = 0.25
RESOLUTION = 0.05


def corridor_with_end(value: int) -> OccupancyGrid:
    """4 m of free floor, 2 m wide, that ends at x = 4 m in cells of ``value``."""
    cells = np.full((60, 100), OCCUPIED, dtype=np.int8)
    cells[10:50, 10:90] = FREE
    cells[10:50, 90:] = value
    return OccupancyGrid(cells, RESOLUTION, (-0.5, -1.5))


def drive(gate: SafetyGate, wanted: Twist2, pose: Pose2, steps: int) -> tuple[Pose2, MotionState, str]:
    """The robot does exactly what the gate sends; the wish is reached under the limits."""
    motion, reason = MotionState(), ""
    for _ in range(steps):
        decision = gate.decide(towards(wanted, motion), pose, motion, DT)
        mean_v = 0.5 * (motion.twist.linear_mps + decision.motion.twist.linear_mps)
        mean_w = 0.5 * (motion.twist.angular_rps + decision.motion.twist.angular_rps)
        heading = pose.yaw_rad + 0.5 * mean_w * DT
        pose = Pose2(
            pose.x + mean_v * DT * math.cos(heading),
            pose.y + mean_v * DT * math.sin(heading),
            pose.yaw_rad + mean_w * DT,
        )
        motion, reason = decision.motion, decision.reason
    return pose, motion, reason


def clearance(grid: OccupancyGrid, pose: Pose2) -> float:
    """Distance from the robot's centre to the nearest cell that is not free, taken as a square."""
    rows, cols = np.nonzero(grid.cells != FREE)
    x0 = grid.origin_xy[0] + cols * RESOLUTION
    y0 = grid.origin_xy[1] + rows * RESOLUTION
    dx = np.maximum(np.maximum(x0 - pose.x, pose.x - x0 - RESOLUTION), 0.0)
    dy = np.maximum(np.maximum(y0 - pose.y, pose.y - y0 - RESOLUTION), 0.0)
    return float(np.hypot(dx, dy).min())


@given(
    st.floats(-1.0, 0.5),
    st.floats(-1.2, 1.2),
    st.floats(-math.pi, math.pi),
    st.sampled_from([OCCUPIED, UNKNOWN]),
)
@settings(deadline=None, max_examples=60)
def test_whatever_is_wanted_the_footprint_never_leaves_free_space(
    v: float, w: float, yaw: float, end: int
) -> None:
    grid = corridor_with_end(end)
    gate = SafetyGate(RADIUS, LIMITS)
    pose, motion = Pose2(2.0, 0.0, yaw), MotionState()
    for _ in range(160):
        gate.see(Surroundings(0.0, np.empty((0, 2)), grid), pose)
        decision = gate.decide(towards(Twist2(v, w), motion), pose, motion, DT)
        mean_v = 0.5 * (motion.twist.linear_mps + decision.motion.twist.linear_mps)
        mean_w = 0.5 * (motion.twist.angular_rps + decision.motion.twist.angular_rps)
        heading = pose.yaw_rad + 0.5 * mean_w * DT
        pose = Pose2(
            pose.x + mean_v * DT * math.cos(heading),
            pose.y + mean_v * DT * math.sin(heading),
            pose.yaw_rad + mean_w * DT,
        )
        motion = decision.motion
        assert clearance(grid, pose) >= RADIUS - 0.005


def test_driving_at_a_wall_ends_at_rest_with_the_reason_in_words() -> None:
    grid = corridor_with_end(OCCUPIED)
    gate = SafetyGate(RADIUS, LIMITS)
    gate.see(Surroundings(0.0, np.empty((0, 2)), grid), Pose2(3.0, 0.0, 0.0))
    pose, motion, reason = drive(gate, Twist2(0.5, 0.0), Pose2(2.5, 0.0, 0.0), 200)
    assert abs(motion.twist.linear_mps) < 1e-3
    assert pose.x < 4.0 - RADIUS
    assert pose.x > 4.0 - RADIUS - 0.15
    assert "in the map, needs 0.250 m" in reason


def test_an_obstacle_only_the_scan_knows_is_enough_to_brake() -> None:
    grid = corridor_with_end(OCCUPIED)
    gate = SafetyGate(RADIUS, LIMITS)
    post = np.array([[2.0, 0.1]])
    gate.see(Surroundings(0.0, post, grid), Pose2(1.0, 0.0, 0.0))
    pose, motion, reason = drive(gate, Twist2(0.5, 0.0), Pose2(0.6, 0.0, 0.0), 200)
    assert abs(motion.twist.linear_mps) < 1e-3
    assert math.hypot(2.0 - pose.x, 0.1 - pose.y) >= RADIUS
    assert "obstacle in the last 15 scans" in reason


def test_a_robot_that_stands_too_close_may_leave_but_not_come_closer() -> None:
    grid = corridor_with_end(OCCUPIED)
    start = Pose2(3.8, 0.0, 0.0)  # 0.2 m from the end wall, the footprint needs 0.25 m
    gate = SafetyGate(RADIUS, LIMITS)
    gate.see(Surroundings(0.0, np.empty((0, 2)), grid), start)
    ahead, _, _ = drive(gate, Twist2(0.3, 0.0), start, 40)
    back, _, _ = drive(gate, Twist2(-0.3, 0.0), start, 40)
    assert abs(ahead.x - start.x) < RESOLUTION
    assert back.x < start.x - 0.3


def test_turning_on_the_spot_is_always_allowed() -> None:
    gate = SafetyGate(RADIUS, LIMITS)
    pose, _, reason = drive(gate, Twist2(0.0, 1.0), Pose2(0.0, 0.0, 0.0), 40)
    assert pose.yaw_rad > 1.0
    assert reason == ""


def test_outside_the_known_map_nothing_but_turning_is_allowed() -> None:
    gate = SafetyGate(RADIUS, LIMITS)
    gate.see(Surroundings(0.0, np.empty((0, 2)), corridor_with_end(OCCUPIED)), Pose2(50.0, 0.0, 0.0))
    pose, _, reason = drive(gate, Twist2(0.5, 0.0), Pose2(50.0, 0.0, 0.0), 40)
    assert pose.x == 50.0
    assert reason

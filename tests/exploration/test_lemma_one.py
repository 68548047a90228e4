"""Lemma 1: in an obstacle-free environment the robot goes straight on along its first heading for ever."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import (
    HalfPlane,
    HalfPlaneHistory,
    find_free_sectors,
    is_allowed,
    next_waypoint,
)
from explore_bt.types import Pose2, Scan2D

L_M = 5.0
STEPS = 400


def open_space(beams: int) -> Scan2D:
    angles = np.linspace(-math.pi, math.pi, beams, endpoint=False)
    return Scan2D(0.0, angles, np.full(beams, np.inf, np.float32), np.zeros(beams), 0.05, L_M)


def drive(
    start: Pose2, scan: Scan2D, window: int | None, step_m: float, revisit_cosine: float
) -> list[Pose2]:
    history, visited, pose = HalfPlaneHistory(), [start], start
    for _ in range(STEPS):
        history = history.push(HalfPlane.ahead_of(pose))
        sectors = find_free_sectors(scan, detection_range_m=L_M, footprint_radius_m=0.25, margin_m=0.03)
        assert len(sectors) == 1
        assert sectors[0].width_rad == pytest.approx(math.pi)
        waypoint = next_waypoint(pose, sectors[0], step_m)
        assert history.contains(waypoint.position, window)
        assert is_allowed(waypoint.pose, visited, L_M, revisit_cosine)
        pose = waypoint.pose
        visited.append(pose)
    return visited


@settings(deadline=None, max_examples=12)
@given(
    st.floats(-math.pi, math.pi, exclude_max=True),
    st.floats(-20, 20),
    st.sampled_from([180, 360, 719]),
    st.sampled_from([1, 3, None]),
    st.sampled_from([L_M, 5.5, 8.0]),
    st.sampled_from([-0.5, 0.5, 0.99]),
)
def test_in_open_space_the_robot_goes_straight_on_for_ever(heading, x, beams, window, step_m, revisit_cosine):
    visited = drive(Pose2(x, -x, heading), open_space(beams), window, step_m, revisit_cosine)
    assert {pose.yaw_rad for pose in visited} == {heading}
    end = visited[-1]
    assert end.x == pytest.approx(x + STEPS * step_m * math.cos(heading), abs=1e-8)
    assert end.y == pytest.approx(-x + STEPS * step_m * math.sin(heading), abs=1e-8)

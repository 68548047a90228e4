import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import UserError
from explore_bt.exploration import FreeSector, next_waypoint
from explore_bt.types import Pose2


@settings(deadline=None)
@given(
    st.floats(-50, 50), st.floats(-50, 50), st.floats(-3.1, 3.1), st.floats(-1.5, 3.0), st.floats(0.1, 3.0)
)
def test_the_waypoint_is_one_step_along_the_bisector_and_keeps_its_heading(x, y, yaw, start, width):
    waypoint = next_waypoint(Pose2(x, y, yaw), FreeSector(start, width, 1.0), 1.7)
    theta = yaw + start + width / 2
    forward = complex(waypoint.pose.x - x, waypoint.pose.y - y) / 1.7
    turn = complex(math.cos(theta), math.sin(theta))
    assert abs(forward - turn) < 1e-9
    assert abs(complex(math.cos(waypoint.heading_rad), math.sin(waypoint.heading_rad)) - turn) < 1e-9
    assert -math.pi <= waypoint.heading_rad < math.pi


def test_a_step_of_no_length_is_refused():
    with pytest.raises(UserError, match="step_length_m: 0"):
        next_waypoint(Pose2.identity(), FreeSector(0.0, 1.0, 1.0), 0.0)

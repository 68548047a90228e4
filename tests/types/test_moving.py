import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.types import MovingObstacle, Pose2

numbers = st.floats(-5.0, 5.0)


@given(numbers, numbers, st.floats(0.0, 2 * np.pi), st.floats(0.0, 1.6), st.floats(0.0, 3.0))
def test_it_never_gets_nearer_than_the_least_distance(
    x: float, y: float, course: float, speed: float, duration: float
) -> None:
    velocity = (speed * np.cos(course), speed * np.sin(course))
    someone = MovingObstacle(1, (x, y), velocity, 0.2, stamp_s=7.0)
    then = someone.at(7.0 + duration)
    surface = np.hypot(*then) - someone.radius_m
    assert surface >= someone.least_distance_m(Pose2.identity(), 7.0 + duration, 1.6) - 1e-9

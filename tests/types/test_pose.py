import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.types import Pose2, wrap_angle

coordinates = st.floats(-100.0, 100.0)
poses = st.builds(Pose2, coordinates, coordinates, st.floats(-math.pi, math.pi, exclude_max=True))


def matrix(pose: Pose2) -> np.ndarray:
    c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    return np.array([[c, -s, pose.x], [s, c, pose.y], [0, 0, 1]])


@given(poses, poses)
def test_composition_is_the_matrix_product(a: Pose2, b: Pose2) -> None:
    np.testing.assert_allclose(matrix(a.compose(b)), matrix(a) @ matrix(b), atol=1e-9)


@given(poses, poses)
def test_between_undoes_composition(a: Pose2, b: Pose2) -> None:
    np.testing.assert_allclose(matrix(a.between(a.compose(b))), matrix(b), atol=1e-9)


@given(poses)
def test_the_inverse_is_the_matrix_inverse(a: Pose2) -> None:
    np.testing.assert_allclose(matrix(a.inverse()), np.linalg.inv(matrix(a)), atol=1e-9)


@given(poses, st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=5))
def test_points_are_carried_like_homogeneous_vectors(a: Pose2, points: list[tuple[float, float]]) -> None:
    homogeneous = np.column_stack((points, np.ones(len(points))))
    np.testing.assert_allclose(a.apply(np.array(points)), (homogeneous @ matrix(a).T)[:, :2], atol=1e-9)


@given(st.floats(-1000.0, 1000.0))
def test_a_wrapped_angle_is_the_same_angle_in_one_turn(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped < math.pi
    np.testing.assert_allclose(
        [math.cos(wrapped), math.sin(wrapped)], [math.cos(angle), math.sin(angle)], atol=1e-9
    )

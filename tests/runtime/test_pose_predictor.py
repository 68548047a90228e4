import math

import numpy as np
import pytest

from explore_bt.runtime.pose_predictor import PosePredictor
from explore_bt.types import Estimate, MotionState, Pose2, Twist2

DT = 0.05


def test_an_old_estimate_is_carried_along_the_commands_sent_since() -> None:
    predictor, pose, motion = PosePredictor(), Pose2(1.0, 2.0, 0.3), MotionState()
    poses = [pose]
    for step in range(20):
        following = MotionState(Twist2(0.02 * step, 0.05 * step))
        predictor.sent(step * DT, motion, following)
        pose = _finely_integrated(pose, motion.twist, following.twist)
        poses.append(pose)
        motion = following
    for begin in (0, 5, 17):
        predicted = predictor.predict(Estimate(begin * DT, poses[begin]), 20 * DT)
        np.testing.assert_allclose(predicted.T_map_base.as_array(), poses[20].as_array(), atol=2e-3)
        assert predicted.stamp_s == pytest.approx(20 * DT)


def test_what_a_lagging_body_still_has_to_drive_counts_as_driven() -> None:
    predictor, steady = PosePredictor(delay_s=0.025), MotionState(Twist2(0.4, 0.0))
    for step in range(20):
        predictor.sent(step * DT, steady, steady)
    predicted = predictor.predict(Estimate(0.5, Pose2(0.0, 0.0, 0.0)), 20 * DT)
    assert predicted.T_map_base.x == pytest.approx(0.4 * (0.5 + 0.025))


def test_a_lagging_body_is_carried_to_where_it_is_and_not_to_where_it_will_be() -> None:
    """The same commands, driven late, give the poses and twists that ``carry`` and ``twist_at`` tell."""
    lag, late = 4, PosePredictor(delay_s=4 * DT)
    motion, pose, poses, twists = MotionState(), Pose2(0.0, 0.0, 0.0), [], []
    sent = [MotionState(Twist2(0.02 * step, 0.04 * step)) for step in range(25)]
    for step, following in enumerate(sent):
        poses.append(pose)
        twists.append(motion.twist)
        late.sent(step * DT, motion, following)
        pose, motion = _finely_integrated(pose, motion.twist, following.twist), following
    for begin, end in ((10, 20), (15, 24)):
        estimate = Estimate(begin * DT, poses[begin - lag])
        carried = late.carry(estimate, end * DT)
        np.testing.assert_allclose(carried.T_map_base.as_array(), poses[end - lag].as_array(), atol=2e-3)
        assert late.twist_at(end * DT).angular_rps == pytest.approx(twists[end - lag].angular_rps)


def test_a_body_that_was_told_nothing_stands() -> None:
    assert PosePredictor(0.2).twist_at(3.0) == Twist2()


def _finely_integrated(pose: Pose2, before: Twist2, after: Twist2) -> Pose2:
    x, y, yaw = pose.x, pose.y, pose.yaw_rad
    for share in (np.arange(100) + 0.5) / 100:
        v = before.linear_mps + share * (after.linear_mps - before.linear_mps)
        w = before.angular_rps + share * (after.angular_rps - before.angular_rps)
        x += v * DT / 100 * math.cos(yaw)
        y += v * DT / 100 * math.sin(yaw)
        yaw += w * DT / 100
    return Pose2(x, y, yaw)


def test_an_estimate_as_new_as_now_is_left_alone() -> None:
    predictor = PosePredictor()
    predictor.sent(0.0, MotionState(Twist2(0.5, 0.0)), MotionState(Twist2(0.5, 0.0)))
    estimate = Estimate(1.0, Pose2(1.0, 1.0, 0.0))
    assert predictor.predict(estimate, 1.0).T_map_base == estimate.T_map_base

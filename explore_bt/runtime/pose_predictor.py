"""Where the robot is now, when the newest estimate is a little old."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

from explore_bt.types import Estimate, MotionState, Pose2

__all__ = ["PosePredictor"]

_MEMORY_S = 2.0


class PosePredictor:
    """Carries an estimate forward along the commands that the body had not done at its stamp.

    Args:
        delay_s: how long the body lags behind its commands. The pose predicted is the one it will have
            reached when it has done all that was sent.
    """

    def __init__(self, delay_s: float = 0.0) -> None:
        self._delay_s = delay_s
        self._sent: deque[tuple[float, MotionState, MotionState]] = deque()

    def sent(self, time_s: float, before: MotionState, after: MotionState) -> None:
        """Note a command: from ``time_s`` on the twist goes from ``before`` to ``after`` within a period."""
        self._sent.append((time_s, before, after))
        while self._sent and self._sent[0][0] < time_s - _MEMORY_S:
            self._sent.popleft()

    def predict(self, estimate: Estimate, now_s: float) -> Estimate:
        """The estimate at ``now_s``; unchanged if it is as new as that."""
        pose = estimate.T_map_base
        for index, (begin_s, before, after) in enumerate(self._sent):
            end_s = self._sent[index + 1][0] if index + 1 < len(self._sent) else now_s
            start_s, stop_s = max(begin_s, estimate.stamp_s - self._delay_s), min(end_s, now_s)
            if stop_s <= start_s:
                continue
            middle = (0.5 * (start_s + stop_s) - begin_s) / (end_s - begin_s)
            v = before.twist.linear_mps + middle * (after.twist.linear_mps - before.twist.linear_mps)
            w = before.twist.angular_rps + middle * (after.twist.angular_rps - before.twist.angular_rps)
            pose = _driven(pose, v, w, stop_s - start_s)
        return replace(estimate, T_map_base=pose, stamp_s=max(now_s, estimate.stamp_s))


def _driven(pose: Pose2, v: float, w: float, duration_s: float) -> Pose2:
    turn = w * duration_s
    middle = pose.yaw_rad + 0.5 * turn
    return Pose2(
        pose.x + v * duration_s * math.cos(middle),
        pose.y + v * duration_s * math.sin(middle),
        pose.compose(Pose2(0.0, 0.0, turn)).yaw_rad,
    )

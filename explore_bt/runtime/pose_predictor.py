"""Where the robot is now, when the newest estimate is a little old."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

from explore_bt.types import Estimate, MotionState, Pose2, Twist2

__all__ = ["PosePredictor"]

_MEMORY_S = 2.0
_USUAL_PERIOD_S = 0.05


class PosePredictor:
    """Carries an estimate forward along the commands that the body had not done at its stamp.

    Args:
        delay_s: how long the body lags behind its commands. The pose predicted is the one it will have
            reached when it has done all that was sent.
    """

    def __init__(self, delay_s: float = 0.0) -> None:
        self._delay_s = delay_s
        self._period_s = _USUAL_PERIOD_S
        self._sent: deque[tuple[float, MotionState, MotionState]] = deque()

    def sent(self, time_s: float, before: MotionState, after: MotionState) -> None:
        """Note a command: from ``time_s`` on the twist goes from ``before`` to ``after`` within a period."""
        if self._sent and time_s > self._sent[-1][0]:
            self._period_s = time_s - self._sent[-1][0]
        self._sent.append((time_s, before, after))
        while self._sent and self._sent[0][0] < time_s - _MEMORY_S:
            self._sent.popleft()

    def twist_at(self, time_s: float) -> Twist2:
        """What the body drove at a time of the last seconds: what had been sent by then, less its lag."""
        sent_s = time_s - self._delay_s
        for index in range(len(self._sent) - 1, -1, -1):
            begin_s, before, after = self._sent[index]
            if begin_s > sent_s:
                continue
            is_last = index + 1 == len(self._sent)
            period_s = self._period_s if is_last else self._sent[index + 1][0] - begin_s
            share = min((sent_s - begin_s) / period_s, 1.0)
            return Twist2(
                before.twist.linear_mps + share * (after.twist.linear_mps - before.twist.linear_mps),
                before.twist.angular_rps + share * (after.twist.angular_rps - before.twist.angular_rps),
            )
        return Twist2()

    def predict(self, estimate: Estimate, now_s: float) -> Estimate:
        """Where the body will be once it has done all that was sent; as it is if it is as new as that."""
        pose = self._along(estimate.T_map_base, estimate.stamp_s - self._delay_s, now_s, now_s)
        return replace(estimate, T_map_base=pose, stamp_s=max(now_s, estimate.stamp_s))

    def carry(self, estimate: Estimate, time_s: float) -> Estimate:
        """Where the body is at a time of the last seconds, its lag counted."""
        begin_s, end_s = estimate.stamp_s - self._delay_s, time_s - self._delay_s
        pose = self._along(estimate.T_map_base, begin_s, end_s, max(self._last_end_s, end_s))
        return replace(estimate, T_map_base=pose, stamp_s=max(time_s, estimate.stamp_s))

    @property
    def _last_end_s(self) -> float:
        return self._sent[-1][0] + self._period_s if self._sent else 0.0

    def _along(self, pose: Pose2, start_s: float, stop_s: float, last_end_s: float) -> Pose2:
        """Along the commands that were in force between two times; the last one ends at ``last_end_s``."""
        for index, (begin_s, before, after) in enumerate(self._sent):
            end_s = self._sent[index + 1][0] if index + 1 < len(self._sent) else last_end_s
            first_s, last_s = max(begin_s, start_s), min(end_s, stop_s)
            if last_s <= first_s:
                continue
            middle = (0.5 * (first_s + last_s) - begin_s) / (end_s - begin_s)
            v = before.twist.linear_mps + middle * (after.twist.linear_mps - before.twist.linear_mps)
            w = before.twist.angular_rps + middle * (after.twist.angular_rps - before.twist.angular_rps)
            pose = _driven(pose, v, w, last_s - first_s)
        return pose


def _driven(pose: Pose2, v: float, w: float, duration_s: float) -> Pose2:
    turn = w * duration_s
    middle = pose.yaw_rad + 0.5 * turn
    return Pose2(
        pose.x + v * duration_s * math.cos(middle),
        pose.y + v * duration_s * math.sin(middle),
        pose.compose(Pose2(0.0, 0.0, turn)).yaw_rad,
    )

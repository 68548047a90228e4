"""Wheel odometry without its jumps."""

from __future__ import annotations

from dataclasses import replace

from explore_bt.types import MotionLimits, Pose2, WheelOdometry

__all__ = ["SmoothOdometry"]

_ALLOWANCE_M = 0.3
_ALLOWANCE_RAD = 0.5
_HASTE = 2.0


class SmoothOdometry:
    """A body cannot jump: where odometry does, it was set anew, and goes on from where it was.

    Args:
        limits: of the body's motion.
    """

    def __init__(self, limits: MotionLimits) -> None:
        self._limits = limits
        self._last: WheelOdometry | None = None
        self._offset = Pose2.identity()

    def take(self, measured: WheelOdometry) -> tuple[WheelOdometry, str]:
        """The measurement, and in words by how much it jumped; empty if it did not."""
        last, self._last = self._last, measured
        words = "" if last is None else self._jump(last, measured)
        if last is not None and words:
            smooth = self._offset.compose(last.T_odom_base)
            self._offset = smooth.compose(measured.T_odom_base.inverse())
        return replace(measured, T_odom_base=self._offset.compose(measured.T_odom_base)), words

    def _jump(self, last: WheelOdometry, measured: WheelOdometry) -> str:
        off = last.T_odom_base.between(measured.T_odom_base)
        dt_s = max(measured.stamp_s - last.stamp_s, 0.0)
        way_m = (off.x**2 + off.y**2) ** 0.5
        too_far = way_m > _ALLOWANCE_M + _HASTE * self._limits.speed_mps * dt_s
        too_wide = abs(off.yaw_rad) > _ALLOWANCE_RAD + _HASTE * self._limits.turn_rate_rps * dt_s
        if not (too_far or too_wide):
            return ""
        return f"it jumped by {way_m:.2f} m and {off.yaw_rad:.2f} rad in {dt_s:.2f} s"

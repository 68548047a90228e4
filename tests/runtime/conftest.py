import numpy as np

from explore_bt.types import MotionLimits, MotionState, Twist2

DT = 0.05
LIMITS = MotionLimits()


def towards(wanted: Twist2, motion: MotionState) -> Twist2:
    """The wish of a controller that goes for a twist under the limits."""

    def step(target: float, now: float, a: float, a_max: float, j_max: float) -> float:
        change = np.clip((target - now) / DT, a - j_max * DT, a + j_max * DT)
        return now + float(np.clip(change, -a_max, a_max)) * DT

    return Twist2(
        step(wanted.linear_mps, motion.twist.linear_mps, motion.linear_acceleration_mps2, 0.5, 2.0),
        step(wanted.angular_rps, motion.twist.angular_rps, motion.angular_acceleration_rps2, 2.0, 8.0),
    )

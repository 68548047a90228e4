"""Turns in place, planned by ruckig and followed with a little feedback."""

from __future__ import annotations

from ruckig import InputParameter, Result, Ruckig, Trajectory

from explore_bt.types import MotionLimits, wrap_angle

__all__ = ["Turn"]

_RESERVE = 0.85  # share of the limits that the plan uses; following it has the rest
_OFF_PLAN_RPS = 0.1  # more than feedback and its limiting can account for
_FEEDBACK_PER_S, _FEEDBACK_RPS = 2.0, 0.05


class Turn:
    """A turn to a heading in the shortest time under velocity, acceleration and jerk limits.

    Ruckig plans the whole turn once (position interface: it ends at rest, exactly there). Planning anew in
    each period from the last sent acceleration would give away half of the jerk. It is planned anew when
    what was sent is not what was planned: the brake was at work, or the limits have changed.
    """

    def __init__(self, target_yaw_rad: float) -> None:
        self.target_yaw_rad = target_yaw_rad
        self._remaining: float | None = None
        self._trajectory: Trajectory | None = None
        self._limits: MotionLimits | None = None
        self._total = 0.0
        self._time_s = 0.0

    @property
    def is_over(self) -> bool:
        """Whether the planned time has passed."""
        return self._trajectory is not None and self._time_s >= self._trajectory.duration

    def remaining(self, yaw_rad: float) -> float:
        """Radians still to go; a turn of more than half a circle keeps its direction."""
        error = wrap_angle(self.target_yaw_rad - yaw_rad)
        if self._remaining is not None:
            error = self._remaining + wrap_angle(error - self._remaining)
        self._remaining = error
        return error

    def wanted_rate(
        self, yaw_rad: float, rate_rps: float, acceleration_rps2: float, limits: MotionLimits, dt_s: float
    ) -> tuple[float, float]:
        """Turn rate for the end of the next period (rad/s), and how fast it then changes (rad/s²).

        Args:
            yaw_rad: the robot's heading.
            rate_rps: turn rate last sent.
            acceleration_rps2: its change over the last period, per second.
            limits: present limits.
            dt_s: the period.
        """
        remaining = self.remaining(yaw_rad)
        off_plan = self._trajectory is None or limits is not self._limits
        if self._trajectory is not None and not off_plan:
            off_plan = abs(rate_rps - self._at(self._time_s)[1]) > _OFF_PLAN_RPS
        if off_plan:
            self._plan(remaining, rate_rps, acceleration_rps2, limits)
        lag = remaining - (self._total - self._at(self._time_s)[0])
        self._time_s += dt_s
        _, rate, gain = self._at(self._time_s)
        return (rate + max(-_FEEDBACK_RPS, min(_FEEDBACK_RPS, _FEEDBACK_PER_S * lag)), gain)

    def _at(self, time_s: float) -> tuple[float, float, float]:
        """Planned angle turned, rate and acceleration at a time; at rest at the end."""
        if self._trajectory is None:
            return (self._total, 0.0, 0.0)
        if time_s >= self._trajectory.duration:
            return (self._total, 0.0, 0.0)
        angle, rate, gain = self._trajectory.at_time(time_s)
        return (angle[0], rate[0], gain[0])

    def _plan(
        self, remaining: float, rate_rps: float, acceleration_rps2: float, limits: MotionLimits
    ) -> None:
        wish = InputParameter(1)
        wish.current_position, wish.target_position = [0.0], [remaining]
        wish.current_velocity, wish.current_acceleration = [rate_rps], [acceleration_rps2]
        wish.target_velocity, wish.target_acceleration = [0.0], [0.0]
        wish.max_velocity = [_RESERVE * limits.turn_rate_rps]
        wish.max_acceleration = [_RESERVE * limits.turn_acceleration_rps2]
        wish.max_jerk = [_RESERVE * limits.turn_jerk_rps3]
        trajectory = Trajectory(1)
        found = Ruckig(1).calculate(wish, trajectory) in (Result.Working, Result.Finished)
        self._trajectory = trajectory if found else None
        self._limits, self._total, self._time_s = limits, remaining, 0.0

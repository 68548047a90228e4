"""Where the robot's body has been of late, step by step: what every sensor measures from."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["ON_STEP", "STEP_S", "Row", "Track"]

STEP_S = 0.002
"""Length of a physical step, seconds: state k belongs to time k * STEP_S."""

ON_STEP = 1e-6
"""A time this near to a step's (in steps) is that step's."""

_ROOM_STEPS = 4096
_MEMORY_STEPS = 1024
"""States that stay when the track is moved up: 2 s, more than the longest sweep takes."""

_POSITION, _QUATERNION = slice(0, 3), slice(3, 7)
_ANGULAR_VELOCITY, _LINEAR_ACCELERATION = slice(7, 10), slice(10, 13)
_WHEELS = slice(13, 15)
_COLUMNS = 15

Row = NDArray[np.float64]
"""(15,) float64: position and quaternion of ``base_link``, what its IMU feels, the wheels' angles."""


class Track:
    """The newest states of the body, one per physical step.

    ``base_link`` is fixed to the body: under the middle of the axle, on the floor while the body stands
    upright, x ahead and z up along the body. World axes are the ``map`` frame's, z = 0 on the floor.

    Attributes:
        first_step, last_step: the oldest and the newest state; state k belongs to time ``k * STEP_S``.
    """

    def __init__(self, row: Row, step: int = 0) -> None:
        """Begin with one state, at an internal step."""
        self._rows = np.zeros((_ROOM_STEPS, _COLUMNS))
        self._rows[0] = row
        self.first_step = self.last_step = step

    def add(self, row: Row) -> None:
        """The next step's state."""
        if self.last_step - self.first_step + 1 >= _ROOM_STEPS:
            self._rows[:_MEMORY_STEPS] = self._rows[-_MEMORY_STEPS:]
            self.first_step = self.last_step - _MEMORY_STEPS + 1
        self.last_step += 1
        self._rows[self.last_step - self.first_step] = row

    @property
    def now(self) -> Row:
        """(15,) view: the newest state."""
        return self._rows[self.last_step - self.first_step, :]

    @property
    def now_s(self) -> float:
        """Time of the newest state, seconds on the mission's clock."""
        return self.last_step * STEP_S

    @property
    def times_s(self) -> NDArray[np.float64]:
        """(N,) float64: time of each state, seconds on the mission's clock."""
        return np.arange(self.first_step, self.last_step + 1, dtype=np.float64) * STEP_S

    @property
    def positions(self) -> NDArray[np.float64]:
        """(N, 3) float64 view: ``base_link``, metres, ``map`` frame."""
        return self._states[:, _POSITION]

    @property
    def quaternions(self) -> NDArray[np.float64]:
        """(N, 4) float64 view: ``base_link`` in ``map``, w x y z."""
        return self._states[:, _QUATERNION]

    @property
    def angular_velocities(self) -> NDArray[np.float64]:
        """(N, 3) float64 view: rad/s, ``base_link`` axes."""
        return self._states[:, _ANGULAR_VELOCITY]

    @property
    def linear_accelerations(self) -> NDArray[np.float64]:
        """(N, 3) float64 view: what the IMU feels, gravity included, m/s², ``base_link`` axes."""
        return self._states[:, _LINEAR_ACCELERATION]

    @property
    def wheels_rad(self) -> NDArray[np.float64]:
        """(N, 2) float64 view: angles of the left and the right wheel against the body, unwrapped."""
        return self._states[:, _WHEELS]

    def due(self, rate_hz: float) -> int:
        """How many samples of a sensor are due by the newest state; the first comes after one period."""
        return math.floor((self.last_step + ON_STEP) * STEP_S * rate_hz)

    def row_of(self, time_s: float) -> int:
        """The state of the step nearest to a time, which the track must still hold."""
        return round(time_s / STEP_S) - self.first_step

    def at(self, times_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions (K, 3) and unit quaternions (K, 4), w x y z, at (K,) times, interpolated.

        Times beyond the track's ends give its end states. In 2 ms no body turns so far that a normalised
        straight line between two quaternions would differ from the arc.
        """
        states = self._states
        places = np.clip(times_s / STEP_S - self.first_step, 0.0, len(states) - 1)
        rows = np.minimum(places.astype(np.int64), max(len(states) - 2, 0))
        after = np.minimum(rows + 1, len(states) - 1)
        share = (places - rows)[:, None]
        poses = (1.0 - share) * states[rows, :7] + share * states[after, :7]
        quaternions = poses[:, _QUATERNION]
        return poses[:, _POSITION], quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)

    @property
    def _states(self) -> NDArray[np.float64]:
        return self._rows[: self.last_step - self.first_step + 1]

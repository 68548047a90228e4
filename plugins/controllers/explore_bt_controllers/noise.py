"""Smooth random sequences, drawn once and used over and over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

__all__ = ["NoiseBank"]

_TIMES = 8  # columns of the bank per sample used at once
_SHARES = (1.0, 0.5, 0.25, 0.1)  # of the full deviation: wide ones find ways, narrow ones make them exact


class NoiseBank:
    """Sequences correlated in time, in pairs of opposite sign.

    Drawing 80 000 normal numbers takes longer than rolling the motions out. A window of the bank at a random
    place, another one for each kind of velocity, combines to more different samples than are ever needed.

    Attributes:
        sequences: (2, K, B) float32: of linear velocity (m/s) and of turn rate (rad/s).
    """

    def __init__(
        self, rng: np.random.Generator, samples: int, steps: int, deviations: tuple[float, float], hold: float
    ) -> None:
        """Draw the bank.

        Args:
            rng: for the bank and for the windows.
            samples: how many are used at once.
            steps: K.
            deviations: standard deviation of linear velocity (m/s) and of turn rate (rad/s).
            hold: steps over which a sequence hangs together.
        """
        self._rng = rng
        self._samples = samples
        pairs = _TIMES * samples // 2
        white = rng.standard_normal((2, steps, pairs))
        smooth = gaussian_filter1d(white, hold, axis=1, mode="reflect")
        smooth *= np.array(deviations)[:, None, None] / smooth.std(axis=(1, 2), keepdims=True)
        smooth *= np.resize(_SHARES, pairs)
        self.sequences: NDArray[np.float32] = np.empty((2, steps, 2 * pairs), dtype=np.float32)
        self.sequences[:, :, 0::2], self.sequences[:, :, 1::2] = smooth, -smooth

    def windows(self) -> tuple[int, int]:
        """First columns for linear velocity and turn rate, of as many columns as there are samples."""
        spare = self.sequences.shape[2] - self._samples
        first, second = self._rng.integers(0, spare + 1, 2)
        return (int(first), int(second))

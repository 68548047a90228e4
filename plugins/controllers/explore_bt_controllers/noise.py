"""Smooth random sequences, drawn once and used over and over."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from explore_bt_controllers.rollout import BLOCK

__all__ = ["NoiseBank"]

_TIMES = 8  # blocks of the bank per block used at once
_SHARES = (1.0, 0.5, 0.25, 0.1)  # of the full deviation: wide ones find ways, narrow ones make them exact


class NoiseBank:
    """Sequences correlated in time, in pairs of opposite sign.

    Drawing 80 000 normal numbers takes longer than rolling the motions out. A run of blocks at a random
    place of the bank, another one for each kind of velocity, combines to more different samples than are ever
    needed. A block lies in one piece: memory is read as fast as it comes.

    Attributes:
        sequences: (2, G, K, BLOCK) float32: of linear velocity (m/s) and of turn rate (rad/s).
    """

    def __init__(
        self, rng: np.random.Generator, samples: int, steps: int, deviations: tuple[float, float], hold: float
    ) -> None:
        """Draw the bank.

        Args:
            rng: for the bank and for the runs of blocks.
            samples: how many are used at once.
            steps: K.
            deviations: standard deviation of linear velocity (m/s) and of turn rate (rad/s).
            hold: steps over which a sequence hangs together.
        """
        self._rng = rng
        self._samples = samples
        self._used = math.ceil(samples / BLOCK)
        blocks = _TIMES * self._used
        white = rng.standard_normal((2, blocks, steps, BLOCK // 2))
        smooth = gaussian_filter1d(white, hold, axis=2, mode="reflect")
        smooth *= np.array(deviations)[:, None, None, None] / smooth.std(axis=(1, 2, 3), keepdims=True)
        smooth *= np.resize(_SHARES, BLOCK // 2)
        self.sequences: NDArray[np.float32] = np.empty((2, blocks, steps, BLOCK), dtype=np.float32)
        self.sequences[..., 0::2], self.sequences[..., 1::2] = smooth, -smooth

    def runs(self) -> tuple[int, int]:
        """First blocks for linear velocity and turn rate, of as many as hold the samples."""
        spare = self.sequences.shape[1] - self._used
        first, second = self._rng.integers(0, spare + 1, 2)
        return (int(first), int(second))

    def mean(self, firsts: tuple[int, int], weights: NDArray[np.float32]) -> NDArray[np.float64]:
        """(2, K) float64: the weighted sum of the sequences of one run.

        Args:
            firsts: see ``runs``.
            weights: (samples,) float32.
        """
        spread = np.zeros(self._used * BLOCK, dtype=np.float32)
        spread[: self._samples] = weights
        return np.asarray(_mean(self.sequences, firsts, spread.reshape(self._used, BLOCK)))


@njit(cache=True, fastmath=True)
def _mean(sequences, firsts, weights):  # type: ignore[no-untyped-def]  # numba kernel
    total = np.zeros((2, sequences.shape[2]))
    for row in range(2):
        for g in range(weights.shape[0]):
            for k in range(sequences.shape[2]):
                part = np.float32(0.0)
                for n in range(weights.shape[1]):
                    part += sequences[row, firsts[row] + g, k, n] * weights[g, n]
                total[row, k] += part
    return total

"""Open tours: in which order to visit places from where the robot stands."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["open_tour"]


@njit(cache=True)
def _cost(order, between, weight, haste):  # type: ignore[no-untyped-def]  # numba kernel
    """Metres of all legs, each counted once and ``haste`` times the share of weight that waits for it."""
    waiting = 0.0
    for i in range(1, order.size):
        waiting += weight[order[i]]
    share = haste / max(waiting, 1e-9)
    total = 0.0
    for i in range(1, order.size):
        total += between[order[i - 1], order[i]] * (1.0 + share * waiting)
        waiting -= weight[order[i]]
    return total


@njit(cache=True)
def _improve(order, between, weight, haste):  # type: ignore[no-untyped-def]  # numba kernel
    """2-opt and or-opt until neither helps; the first place stays first, the end is open."""
    n = order.size
    best = _cost(order, between, weight, haste)
    trial = order.copy()
    improved = True
    while improved:
        improved = False
        for i in range(1, n - 1):
            for j in range(i + 1, n):
                trial[:] = order
                trial[i : j + 1] = order[i : j + 1][::-1]
                cost = _cost(trial, between, weight, haste)
                if cost < best - 1e-6:
                    best, improved = cost, True
                    order[:] = trial
        for length in range(1, 4):
            for i in range(1, n - length + 1):
                for at in range(1, n - length + 1):
                    if at == i:
                        continue
                    piece = order[i : i + length].copy()
                    rest = np.concatenate((order[:i], order[i + length :]))
                    trial[:at] = rest[:at]
                    trial[at : at + length] = piece
                    trial[at + length :] = rest[at:]
                    cost = _cost(trial, between, weight, haste)
                    if cost < best - 1e-6:
                        best, improved = cost, True
                        order[:] = trial
    return order


@njit(cache=True)
def _nearest_first(between):  # type: ignore[no-untyped-def]  # numba kernel
    n = between.shape[0]
    order = np.zeros(n, dtype=np.int64)
    left = np.ones(n, dtype=np.bool_)
    left[0] = False
    for i in range(1, n):
        here, best = order[i - 1], -1
        for k in range(n):
            if left[k] and (best < 0 or between[here, k] < between[here, best]):
                best = k
        order[i] = best
        left[best] = False
    return order


def open_tour(
    between_m: NDArray[np.float64], weight: NDArray[np.float64] | None = None, haste: float = 0.0
) -> NDArray[np.int64]:
    """A short order through all places from the first one on, not coming back.

    Nearest neighbour, then 2-opt (Croes, 1958) and or-opt (Or, 1976): within some percent of the best.
    With ``haste`` a metre counts 1 + haste × the share of all weight that still waits for it: between the
    travelling salesman (0) and the travelling repairman (∞), who keeps the sum of waiting short.

    Args:
        between_m: (N, N) float64, metres from row to column; place 0 is where the tour begins.
        weight: (N,) float64, what each place is worth; all the same by default.
        haste: see above.

    Returns:
        (N,) int64, a permutation of the places that begins with 0.
    """
    between = np.ascontiguousarray(between_m, dtype=np.float64)
    weights = np.ones(len(between)) if weight is None else np.ascontiguousarray(weight, dtype=np.float64)
    return np.asarray(_improve(_nearest_first(between), between, weights, float(haste)))

"""A short order in which to visit places: an open travelling-salesman path with a fixed beginning."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["shorter_order"]

_GAIN = 1e-9


@njit(cache=True)
def _leg(distance, order, i, j):  # type: ignore[no-untyped-def]  # numba kernel
    """Length between the i-th and the j-th stop; nothing past the open end."""
    if j >= order.shape[0]:
        return 0.0
    return distance[order[i], order[j]]


@njit(cache=True)
def _reverse_pieces(distance, order):  # type: ignore[no-untyped-def]  # numba kernel
    """2-opt: turn round any piece that makes the path shorter; whether one did."""
    count, better = order.shape[0], False
    for i in range(1, count - 1):
        for j in range(i + 1, count):
            old = _leg(distance, order, i - 1, i) + _leg(distance, order, j, j + 1)
            new = _leg(distance, order, i - 1, j) + (
                distance[order[i], order[j + 1]] if j + 1 < count else 0.0
            )
            if new < old - _GAIN:
                order[i : j + 1] = order[i : j + 1][::-1].copy()
                better = True
    return better


@njit(cache=True)
def _move_pieces(distance, order):  # type: ignore[no-untyped-def]  # numba kernel
    """Or-opt: move a piece of one to three stops to where it makes the path shorter; whether one did."""
    count, better = order.shape[0], False
    for size in range(1, 4):
        for i in range(1, count - size + 1):
            first, last = order[i], order[i + size - 1]
            after = order[i + size] if i + size < count else -1
            saved = distance[order[i - 1], first]
            if after >= 0:
                saved += distance[last, after] - distance[order[i - 1], after]
            best, best_to, turned = saved - _GAIN, -1, False
            for to in range(count):  # put it behind that stop
                if i - 1 <= to < i + size:
                    continue
                here, following = order[to], (order[to + 1] if to + 1 < count else -1)
                for turn in range(2):
                    head, tail = (first, last) if turn == 0 else (last, first)
                    added = distance[here, head]
                    if following >= 0:
                        added += distance[tail, following] - distance[here, following]
                    if added < best:
                        best, best_to, turned = added, to, turn == 1
            if best_to < 0:
                continue
            piece = order[i : i + size].copy()
            if turned:
                piece = piece[::-1].copy()
            rest = np.concatenate((order[:i], order[i + size :]))
            at = best_to + 1 if best_to < i else best_to + 1 - size
            order[:at] = rest[:at]
            order[at : at + size] = piece
            order[at + size :] = rest[at:]
            better = True
    return better


@njit(cache=True)
def _improve(distance, order):  # type: ignore[no-untyped-def]  # numba kernel
    for _ in range(50):
        reversed_one = _reverse_pieces(distance, order)
        moved_one = _move_pieces(distance, order)
        if not (reversed_one or moved_one):
            break


def shorter_order(distance: NDArray[np.float64], order: NDArray[np.int64]) -> NDArray[np.int64]:
    """The order after 2-opt (Croes, 1958) and Or-opt (Or, 1976) until neither makes it shorter.

    Args:
        distance: (N, N) float64, symmetric.
        order: (M,) int64 numbers of places; the first one stays first, the last one is free.

    Returns:
        (M,) int64, the same places.
    """
    better = np.array(order, dtype=np.int64)
    if len(better) > 2:
        _improve(np.ascontiguousarray(distance), better)
    return better

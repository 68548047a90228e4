"""A binary heap in two arrays, for compiled searches.

Keys are float64: in float32 two costs that differ fall together, and nodes are silently lost.
"""

from __future__ import annotations

from numba import njit

__all__ = ["pop", "push"]


@njit(cache=True)
def push(keys, nodes, size, key, node):  # type: ignore[no-untyped-def]  # numba kernel
    """Insert; returns the new size. The arrays must have room."""
    i = size
    while i > 0:
        parent = (i - 1) >> 1
        if keys[parent] <= key:
            break
        keys[i], nodes[i] = keys[parent], nodes[parent]
        i = parent
    keys[i], nodes[i] = key, node
    return size + 1


@njit(cache=True)
def pop(keys, nodes, size):  # type: ignore[no-untyped-def]  # numba kernel
    """Remove the entry at index 0, which the caller has read; returns the new size."""
    size -= 1
    key, node = keys[size], nodes[size]
    i = 0
    while True:
        child = 2 * i + 1
        if child >= size:
            break
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[i], nodes[i] = keys[child], nodes[child]
        i = child
    keys[i], nodes[i] = key, node
    return size

"""Occupancy by log-odds, drawn along exact rays."""

from __future__ import annotations

import numpy as np
from numba import njit

from explore_bt.types import FREE, OCCUPIED
from explore_bt_slam.arrays import Bools, Bytes, Floats, Ints, Ints32, Singles

__all__ = ["CLEAREST", "HIT", "MISS", "SOLIDEST", "draw_sweep"]

HIT = 0.9
MISS = -0.4
SOLIDEST = 3.5
CLEAREST = -3.0
_FREE = FREE
_OCCUPIED = OCCUPIED


@njit(cache=True)
def _teach(evidence: Singles, cells: Bytes, row: int, col: int, weight: float, window: Ints) -> None:
    """Add evidence to a cell; ``window`` grows by the cell if its class changes."""
    value = min(max(evidence[row, col] + weight, CLEAREST), SOLIDEST)
    evidence[row, col] = value
    state = _OCCUPIED if value > 0.0 else _FREE
    if cells[row, col] != state:
        cells[row, col] = state
        window[0], window[1] = min(window[0], row), min(window[1], col)
        window[2], window[3] = max(window[2], row + 1), max(window[3], col + 1)


@njit(cache=True)
def draw_sweep(
    evidence: Singles,
    cells: Bytes,
    drawn: Ints32,
    sweep_id: int,
    corner: Floats,
    cell_m: float,
    pose: Floats,
    origins: Singles,
    ends: Singles,
    hit: Bools,
    body_m: float,
    window: Ints,
) -> None:
    """Draw one sweep; each cell learns from it once, and a hit outweighs the rays that graze the cell.

    Misses stop short of the beam's last cell, hit or not (Amanatides and Woo 1987).

    Args:
        evidence: (rows, cols) float32 log-odds, changed in place.
        cells: (rows, cols) int8 FREE / OCCUPIED / UNKNOWN, changed in place.
        drawn: (rows, cols) int32: the last sweep that taught each cell.
        sweep_id: a number no sweep before had.
        corner: (2,) x, y of the lower left corner, metres.
        cell_m: side of a cell.
        pose: (3,) of the base, ``map`` frame.
        origins: (N, 2) where the beams began, base frame; all of the sweep must lie inside the canvas.
        ends: (N, 2) where they ended, base frame.
        hit: (N,) whether on something.
        body_m: radius of the disc about the base that is free because the robot is there.
        window: (4,) int64 row0, col0, row1, col1: grows to hold every cell whose class changed.
    """
    starts = _in_cells(origins, pose, corner, cell_m)
    tips = _in_cells(ends, pose, corner, cell_m)
    for i in range(tips.shape[0]):
        row, col = int(np.floor(tips[i, 1])), int(np.floor(tips[i, 0]))
        if hit[i] and drawn[row, col] != sweep_id:
            drawn[row, col] = sweep_id
            _teach(evidence, cells, row, col, HIT, window)
    for i in range(tips.shape[0]):
        _clear_ray(
            evidence, cells, drawn, sweep_id, starts[i, 0], starts[i, 1], tips[i, 0], tips[i, 1], window
        )
    x, y = (pose[0] - corner[0]) / cell_m, (pose[1] - corner[1]) / cell_m
    _clear_disc(evidence, cells, drawn, sweep_id, x, y, body_m / cell_m, window)


@njit(cache=True)
def _in_cells(points: Singles, pose: Floats, corner: Floats, cell_m: float) -> Floats:
    """(N, 2) x, y on the canvas, in cells, of points in the base frame."""
    out = np.empty((points.shape[0], 2))
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for i in range(points.shape[0]):
        out[i, 0] = (pose[0] + cos * points[i, 0] - sin * points[i, 1] - corner[0]) / cell_m
        out[i, 1] = (pose[1] + sin * points[i, 0] + cos * points[i, 1] - corner[1]) / cell_m
    return out


@njit(cache=True)
def _clear_ray(
    evidence: Singles,
    cells: Bytes,
    drawn: Ints32,
    sweep_id: int,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    window: Ints,
) -> None:
    """Teach every cell that a ray enters, but the last, that it is free; units are cells."""
    col, row = int(np.floor(x0)), int(np.floor(y0))
    col_end, row_end = int(np.floor(x1)), int(np.floor(y1))
    dx, dy = x1 - x0, y1 - y0
    step_col, step_row = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    next_x = ((col + (step_col > 0)) - x0) / dx if dx != 0.0 else np.inf
    next_y = ((row + (step_row > 0)) - y0) / dy if dy != 0.0 else np.inf
    per_x = 1.0 / abs(dx) if dx != 0.0 else np.inf
    per_y = 1.0 / abs(dy) if dy != 0.0 else np.inf
    for _ in range(abs(col_end - col) + abs(row_end - row)):
        if drawn[row, col] != sweep_id:
            drawn[row, col] = sweep_id
            _teach(evidence, cells, row, col, MISS, window)
        # at the end cell's column (row) only rows (columns) are left to walk
        if row == row_end or (col != col_end and next_x < next_y):
            col += step_col
            next_x += per_x
        else:
            row += step_row
            next_y += per_y


@njit(cache=True)
def _clear_disc(
    evidence: Singles,
    cells: Bytes,
    drawn: Ints32,
    sweep_id: int,
    x: float,
    y: float,
    radius: float,
    window: Ints,
) -> None:
    for row in range(int(np.floor(y - radius)), int(np.floor(y + radius)) + 1):
        for col in range(int(np.floor(x - radius)), int(np.floor(x + radius)) + 1):
            inside = (col + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2 <= radius * radius
            if inside and drawn[row, col] != sweep_id:
                drawn[row, col] = sweep_id
                _teach(evidence, cells, row, col, MISS, window)

from __future__ import annotations

import numpy as np
from explore_bt_slam.log_odds import CLEAREST, HIT, MISS, SOLIDEST, draw_sweep
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.types import FREE, OCCUPIED, UNKNOWN

CELL_M = 0.05
SIDE = 60


class Sheet:
    """A blank canvas of 3 × 3 m with its corner at (-1.5, -1.5)."""

    def __init__(self) -> None:
        self.evidence = np.zeros((SIDE, SIDE), np.float32)
        self.cells = np.full((SIDE, SIDE), UNKNOWN, np.int8)
        self.drawn = np.zeros((SIDE, SIDE), np.int32)
        self.window = np.array([SIDE, SIDE, 0, 0])
        self.sweeps = 0

    def draw(
        self,
        pose: NDArray[np.float64],
        ends: NDArray[np.float64],
        hit: NDArray[np.bool_],
        body_m: float = 0.0,
    ) -> None:
        self.sweeps += 1
        corner = np.array([-1.5, -1.5])
        origins = np.zeros_like(ends, dtype=np.float32)
        draw_sweep(
            self.evidence, self.cells, self.drawn, self.sweeps, corner, CELL_M,
            pose, origins, ends.astype(np.float32), hit, body_m, self.window,
        )  # fmt: skip


def slow_evidence(
    pose: NDArray[np.float64], ends: NDArray[np.float64], hit: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """The same by asking of every cell whether a ray's segment crosses its open square."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    ends = ends.astype(np.float32).astype(np.float64)
    tips = (
        np.column_stack((c * ends[:, 0] - s * ends[:, 1], s * ends[:, 0] + c * ends[:, 1])) + pose[:2] + 1.5
    ) / CELL_M
    start = (pose[:2] + 1.5) / CELL_M
    out = np.zeros((SIDE, SIDE))
    for row in range(SIDE):
        for col in range(SIDE):
            low, high = np.array([col, row]), np.array([col + 1, row + 1])
            for tip, is_hit in zip(tips, hit, strict=True):
                if is_hit and (np.floor(tip) == low).all():
                    out[row, col] = HIT
            if out[row, col] == 0.0:
                for tip in tips:
                    if not (np.floor(tip) == low).all() and _crosses(start, tip, low, high):
                        out[row, col] = MISS
    return out


def _crosses(
    start: NDArray[np.float64], tip: NDArray[np.float64], low: NDArray[np.int64], high: NDArray[np.int64]
) -> bool:
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - start) / (tip - start), (high - start) / (tip - start)
    enter, leave = max(np.minimum(a, b).max(), 0.0), min(np.maximum(a, b).min(), 1.0)
    return bool(leave - enter > 1e-9)


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_rays_teach_exactly_the_cells_that_they_cross(seed: int, beams: int) -> None:
    rng = np.random.default_rng(seed)
    pose = np.array([*rng.uniform(-0.3, 0.3, 2), rng.uniform(-3.0, 3.0)])
    angle, reach = rng.uniform(-np.pi, np.pi, beams), rng.uniform(0.05, 1.1, beams)
    ends = np.column_stack((reach * np.cos(angle), reach * np.sin(angle)))
    hit = rng.random(beams) < 0.6
    sheet = Sheet()
    sheet.draw(pose, ends, hit)
    assert np.allclose(sheet.evidence, slow_evidence(pose, ends, hit), atol=1e-6)


def test_the_window_bounds_exactly_the_cells_whose_class_changed() -> None:
    sheet = Sheet()
    sheet.draw(np.zeros(3), np.array([[1.0, 0.02], [0.3, -0.6]]), np.array([True, False]))
    rows, cols = np.nonzero(sheet.cells != UNKNOWN)
    assert sheet.window.tolist() == [rows.min(), cols.min(), rows.max() + 1, cols.max() + 1]


def test_a_cell_once_hit_is_cleared_by_looking_through_it_long_enough() -> None:
    sheet = Sheet()
    hit, through = np.array([[0.52, 0.02]]), np.array([[1.0, 0.02]])
    for _ in range(50):
        sheet.draw(np.zeros(3), hit, np.array([True]))
    row, col = 30, 40
    assert sheet.evidence[row, col] == np.float32(SOLIDEST)
    sheet.draw(np.zeros(3), through, np.array([True]))
    assert sheet.cells[row, col] == OCCUPIED
    for _ in range(12):
        sheet.draw(np.zeros(3), through, np.array([True]))
    assert sheet.cells[row, col] == FREE
    assert sheet.evidence.min() >= np.float32(CLEAREST)


def test_a_hit_outweighs_the_rays_of_the_same_sweep_that_graze_it() -> None:
    sheet = Sheet()
    grazing = np.array([[0.52 + 0.05 * k, 0.02] for k in range(10)])
    sheet.draw(np.zeros(3), grazing, np.ones(10, np.bool_))
    assert (sheet.cells[30, 40:50] == OCCUPIED).all()


def test_the_robots_body_is_free_floor() -> None:
    sheet = Sheet()
    sheet.draw(np.zeros(3), np.zeros((0, 2)), np.zeros(0, np.bool_), body_m=0.25)
    centres = (np.argwhere(sheet.cells == FREE) + 0.5) * CELL_M - 1.5
    assert np.hypot(*centres.T).max() <= 0.25
    assert abs(len(centres) * CELL_M**2 - np.pi * 0.25**2) < 0.02

from __future__ import annotations

import numpy as np
from explore_bt_slam.voxel_kernels import BRICK, allocate, take_in, trace
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

CELL_M = 0.1
SHAPE = (24, 24, 12)
CORNER = np.array([-1.2, -1.2, -0.2])


def traced(
    origins: NDArray[np.float64], ends: NDArray[np.float64], pose: NDArray[np.float64]
) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    scratch, touched = np.zeros(SHAPE, np.uint8), np.zeros(SHAPE[:2], np.bool_)
    rays = (origins.astype(np.float32), ends.astype(np.float32))
    trace(*rays, pose, CORNER, CELL_M, 0.0, scratch, touched)
    return scratch, touched


def slow_marks(
    origins: NDArray[np.float64], ends: NDArray[np.float64], pose: NDArray[np.float64]
) -> NDArray[np.uint8]:
    """By asking of every voxel whether a ray's segment crosses its open cube."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    place = np.array([pose[0], pose[1], 0.0]) - CORNER
    starts, tips = (
        (part.astype(np.float32).astype(np.float64) @ turn.T + place) / CELL_M for part in (origins, ends)
    )
    struck = {tuple(np.floor(tip).astype(int)[[1, 0, 2]]): k for k, tip in reversed(list(enumerate(tips)))}
    marks = np.zeros(SHAPE, np.uint8)
    low = np.stack(np.meshgrid(*(np.arange(n) for n in SHAPE), indexing="ij"), axis=-1)[..., [1, 0, 2]]
    for k, (start, tip) in enumerate(zip(starts, tips, strict=True)):
        inside = (np.floor(tip) >= 0).all() and (np.floor(tip)[[1, 0, 2]] < SHAPE).all()
        if inside and struck[tuple(np.floor(tip).astype(int)[[1, 0, 2]])] != k:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (low - start) / (tip - start), (low + 1 - start) / (tip - start)
        enter = np.maximum(np.minimum(a, b).max(axis=-1), 0.0)
        leave = np.minimum(np.maximum(a, b).min(axis=-1), 1.0)
        column = [v for v in struck if v[:2] == tuple(np.floor(tip).astype(int)[[1, 0]])]
        level = int(np.floor(tip[2]))
        lone = not any(0 <= v[2] < SHAPE[2] and 0 < abs(v[2] - level) <= 3 for v in column)
        boxed = all(0 <= i < n for i, n in zip(np.floor(tip)[[1, 0]], SHAPE, strict=False))
        late = enter >= 1.0 - 0.5 / CELL_M / np.linalg.norm(tip - start)
        spared = (low[..., 2] == level) & late & (lone and boxed)
        marks[(leave - enter > 1e-9) & ~(low == np.floor(tip)).all(axis=-1) & ~spared] = 1
    for voxel in struck:
        if all(0 <= i < n for i, n in zip(voxel, SHAPE, strict=True)):
            marks[voxel] = 2
    return marks


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
def test_rays_mark_exactly_the_voxels_that_they_cross(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    pose = np.array([*rng.uniform(-0.2, 0.2, 2), rng.uniform(-3.0, 3.0)])
    origins = np.array([0.0, 0.0, 0.4]) + rng.uniform(-0.03, 0.03, (count, 3))
    ends = rng.uniform([-1.4, -1.4, -0.4], [1.4, 1.4, 1.3], (count, 3))
    scratch, touched = traced(origins, ends, pose)
    assert np.array_equal(scratch, slow_marks(origins, ends, pose))
    assert np.array_equal(touched, scratch.any(axis=2))


def test_evidence_is_added_and_clamped_and_never_unknown_again() -> None:
    table = np.full((2, 2), -1, np.int32)
    pool = np.zeros((4, BRICK, BRICK, 12), np.int8)
    dirty = np.empty(SHAPE[:2], np.bool_)
    seen: list[int] = []
    changes: list[bool] = []
    used = 0
    for sweep in range(40):
        away = 0.85 if sweep < 10 else 1.05
        ends = np.array([[away, 0.05, 0.45], [away, 0.05, 0.55]])
        scratch, touched = traced(np.array([[0.05, 0.05, 0.45]] * 2), ends, np.zeros(3))
        used = allocate(touched, 4, 4, table, used)
        take_in(scratch, touched, 4, 4, table, pool, dirty)
        assert not scratch.any()
        assert not touched.any()
        row, col = 12 + 4, 20 + 4
        seen.append(int(pool[table[row // BRICK, col // BRICK], row % BRICK, col % BRICK, 6]))
        changes.append(bool(dirty[12, 20]))
    assert seen[:5] == [9, 18, 27, 35, 35]
    assert seen[9:20] == [35, 31, 27, 23, 19, 15, 11, 7, 3, -1, -5]
    assert seen[-1] == -30
    assert 0 not in seen
    assert [k for k, changed in enumerate(changes) if changed] == [0, 16, 18, 20]
    assert used == int((table >= 0).sum())


def test_bricks_are_made_only_where_something_was_seen() -> None:
    table = np.full((8, 8), -1, np.int32)
    touched = np.zeros((64, 64), np.bool_)
    touched[20:30, 3:5] = True
    used = allocate(touched, 32, 32, table, 5)
    assert used == 6
    assert np.argwhere(table >= 0).tolist() == [[3, 2]]
    assert table[3, 2] == 5

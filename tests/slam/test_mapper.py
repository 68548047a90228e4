from __future__ import annotations

import numpy as np
from explore_bt_slam.canvas import Canvas
from explore_bt_slam.mapper import Mapper
from explore_bt_slam.sweep import Sweep

from explore_bt.types import FREE, OCCUPIED, Pose2


def disc(stamp_s: float, reach_m: float = 2.0) -> Sweep:
    angles = np.linspace(-np.pi, np.pi, 180, endpoint=False)
    ends = (reach_m * np.column_stack((np.cos(angles), np.sin(angles)))).astype(np.float32)
    return Sweep(stamp_s, np.zeros_like(ends), ends, np.ones(180, np.bool_))


def walked(keyframes: list[Pose2]) -> Mapper:
    mapper = Mapper(0.05, 0.25)
    mapper.begin(keyframes[0], Pose2.identity())
    for index, pose in enumerate(keyframes):
        mapper.follow(np.array([each.as_array() for each in keyframes[: index + 1]]))
        for step in range(3):
            mapper.see(disc(index + 0.1 * step), index, pose, Pose2(0.15 * step, 0.0, 0.0))
    return mapper


def test_a_redraw_after_the_graph_moved_equals_drawing_from_scratch() -> None:
    before = [Pose2(0.5 * k, 0.0, 0.0) for k in range(6)]
    after = [Pose2(0.5 * k, 0.03 * k, 0.02 * k) for k in range(6)]
    moved = walked(before)
    moved.follow(np.array([pose.as_array() for pose in after]))
    fresh = Canvas(0.05, 0.25)
    for kept in moved.kept:
        fresh.draw(kept.sweep, after[kept.keyframe].compose(kept.relative))
    ours, theirs = moved.grid(), fresh.snapshot()
    seen = np.argwhere(~theirs.unknown)
    there = ours.cells_of(theirs.centers_of(seen))
    assert (ours.cells[there[:, 0], there[:, 1]] == theirs.cells[seen[:, 0], seen[:, 1]]).all()
    assert np.count_nonzero(~ours.unknown) == len(seen)


def test_a_graph_that_hardly_moved_is_not_redrawn() -> None:
    poses = [Pose2(0.5 * k, 0.0, 0.0) for k in range(4)]
    mapper = walked(poses)
    revision = mapper.revision
    mapper.follow(np.array([[pose.x + 0.005, pose.y, pose.yaw_rad] for pose in poses]))
    assert mapper.revision == revision
    mapper.follow(np.array([[pose.x + 0.02, pose.y, pose.yaw_rad] for pose in poses]))
    assert mapper.revision > revision
    assert mapper.changed_since(revision) is None


def test_standing_still_neither_keeps_sweeps_nor_goes_on_changing_the_map() -> None:
    mapper = walked([Pose2(0.0, 0.0, 0.0)])
    kept = len(mapper.kept)
    for step in range(200):
        mapper.see(disc(10.0 + 0.1 * step), 0, Pose2.identity(), Pose2(0.3, 0.0, 0.0))
        if step == 100:
            revision = mapper.revision
    assert len(mapper.kept) == kept
    assert mapper.revision == revision


def test_the_canvas_grows_by_chunks_and_keeps_what_it_knew() -> None:
    canvas = Canvas(0.05, 0.25)
    canvas.draw(disc(0.0), Pose2(0.0, 0.0, 0.0))
    small = canvas.snapshot()
    canvas.draw(disc(1.0), Pose2(-6.0, 3.0, 0.0))
    large = canvas.snapshot()
    assert canvas.changed_since(small.revision) is None
    grown = np.array(large.shape) - np.array(small.shape)
    assert (grown % 100 == 0).all()
    assert (grown > 0).all()
    corner = np.array(large.origin_xy) / 0.05
    assert np.allclose(corner, np.round(corner), atol=1e-9)
    assert large.value_at(0.0, 1.0) == FREE
    assert large.value_at(-6.0, 3.0) == FREE


def test_changed_since_joins_the_windows_of_several_revisions() -> None:
    canvas = Canvas(0.05, 0.25)
    canvas.draw(disc(0.0, 2.4), Pose2(0.0, 0.0, 0.0))
    first = canvas.snapshot()
    for step in range(1, 4):
        canvas.draw(disc(float(step), 2.0), Pose2(0.05 * step, 0.1, 0.0))
    last = canvas.snapshot()
    window = canvas.changed_since(first.revision)
    assert window is not None
    assert first.shape == last.shape
    outside = first.cells != last.cells
    outside[window.slices] = False
    assert not outside.any()
    assert canvas.changed_since(last.revision + 1) is None


def probe(stamp_s: float, reach_m: float) -> Sweep:
    """One beam ahead, and one beside it that sees a chair leg of two cells."""
    ends = np.array([[reach_m, 0.0], [1.0, 0.5]], dtype=np.float32)
    return Sweep(stamp_s, np.zeros_like(ends), ends, np.ones(2, np.bool_))


def test_an_obstacle_in_free_space_has_to_last_and_its_size_does_not_matter() -> None:
    canvas = Canvas(0.05, 0.25)
    for step in range(30):
        canvas.draw(probe(0.1 * step, 3.0), Pose2.identity())
    assert is_drawn(canvas, 1.0, 0.5), "a leg seen from the start is there"
    drawn = []
    for step in range(30, 40):
        canvas.draw(probe(0.1 * step, 1.5), Pose2.identity())
        drawn.append(is_drawn(canvas, 1.5, 0.0))
    assert not any(drawn[:2]), "two returns after thirty beams that passed are no obstacle"
    assert drawn[-1], "one that stays is, be it a single cell"


def is_drawn(canvas: Canvas, x: float, y: float) -> bool:
    grid = canvas.snapshot()
    row, col = grid.cell_of(x, y)
    return bool((grid.cells[row - 1 : row + 2, col - 1 : col + 2] == OCCUPIED).any())

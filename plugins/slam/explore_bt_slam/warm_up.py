"""Run every compiled kernel once, so that none compiles while the robot drives."""

from __future__ import annotations

import numpy as np

from explore_bt.types import Imu, Pose2, Scan2D
from explore_bt_slam.correlative import ScoreGrid, search
from explore_bt_slam.pipeline import Pipeline
from explore_bt_slam.sight import Sight
from explore_bt_slam.sight_match import match_sights
from explore_bt_slam.sight_store import SightStore

__all__ = ["warm_up"]


def warm_up(pipeline: Pipeline) -> None:
    """Drive a throw-away pipeline a step through a square room."""
    for step in range(16):
        stamp_s = 0.1 * step
        pipeline.take_imu(Imu(stamp_s, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81)))
        pipeline.take_scan(_room(stamp_s, 0.05 * step))
    keyframes, poses = pipeline.back.keyframes, pipeline.back.poses
    search(ScoreGrid(keyframes[0].points, 0.5), keyframes[0].points, Pose2(*poses[0].tolist()), 0.2, 0.1)
    _recognise_itself()
    pipeline.estimate()
    pipeline.mapper.redraw(poses)


def _recognise_itself() -> None:
    """A sight of noise, filed and found again."""
    rng = np.random.default_rng(0)
    points = rng.uniform(1.0, 3.0, (20, 3)).astype(np.float32)
    sight = Sight(rng.integers(0, 256, (20, 32), dtype=np.uint8), points, np.full(20, 0.01, np.float32))
    store = SightStore()
    store.add(0, sight)
    store.votes(sight)
    match_sights(sight, sight)


def _room(stamp_s: float, x: float) -> Scan2D:
    """A 4 m square seen from (x, 0) off its centre, facing along x."""
    angles = np.linspace(-np.pi, np.pi, 180, endpoint=False)
    cos, sin = np.cos(angles), np.sin(angles)
    wall_x = np.where(cos > 0.0, 2.0 - x, 2.0 + x)
    ranges = np.minimum(wall_x / np.maximum(np.abs(cos), 1e-9), 2.0 / np.maximum(np.abs(sin), 1e-9))
    times = np.linspace(-0.1, 0.0, 180)
    return Scan2D(stamp_s, angles, ranges.astype(np.float32), times, 0.05, 5.0)

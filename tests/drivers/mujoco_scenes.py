"""Worlds in MuJoCo for tests of what is seen of them, and courses without a body to drive them."""

import math
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
from explore_bt_drivers.mujoco.scene import Scene, Surroundings, build_scene
from explore_bt_drivers.mujoco.track import STEP_S, Track
from explore_bt_drivers.people import Town
from explore_bt_drivers.world import load_world

HEAD = "format: explore-bt-world/1\n"
Course = Callable[[float], tuple[float, float, float, float, float]]
"""Seconds to x, y, yaw, pitch, roll."""


def scene_of(folder: Path, text: str) -> Scene:
    path = folder / "world.yaml"
    path.write_text(HEAD + text)
    world = load_world(path)
    crowd = Town(world, (0.0, 0.0)).crowd(np.random.default_rng(0))
    return build_scene(world, crowd, np.random.default_rng(0))


def compiled(scene: Scene) -> tuple[mujoco.MjModel, mujoco.MjData, Surroundings]:
    model = scene.spec.compile()
    data = mujoco.MjData(model)
    surroundings = Surroundings(scene, model, 0.25)
    surroundings.settle(data, 0, 0.0, 0.0)
    mujoco.mj_forward(model, data)
    return model, data, surroundings


def rotation(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (math.cos, math.sin))
    z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    return z @ y @ x


def row_of(x: float, y: float, yaw: float, pitch: float = 0.0, roll: float = 0.0) -> np.ndarray:
    row = np.zeros(15)
    row[:2] = x, y
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, rotation(yaw, pitch, roll).ravel())
    row[3:7] = quaternion if quaternion @ [1.0, 0.0, 0.0, 0.0] >= 0.0 else -quaternion
    return row


def track_of(course: Course, seconds: float) -> Track:
    track = Track(row_of(*course(0.0)))
    for step in range(1, round(seconds / STEP_S) + 1):
        row = row_of(*course(step * STEP_S))
        if row[3:7] @ track.quaternions[-1] < 0.0:
            row[3:7] *= -1.0
        track.add(row)
    return track


def at_rest(x: float, y: float, yaw: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> Course:
    return lambda _: (x, y, yaw, pitch, roll)

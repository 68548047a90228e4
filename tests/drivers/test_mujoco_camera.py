import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

pytest.importorskip("mujoco")

from explore_bt_drivers.mujoco.camera import RgbdCamera
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.scene import Scene

from explore_bt.errors import UserError
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.types import RgbdFrame

from .mujoco_scenes import Course, at_rest, compiled, rotation, scene_of, track_of

HALL = "bounds: [-4, -3, 4, 3]\n"
MOUNT = np.array([0.05, 0.02, 0.4])
SCENES = {
    "plane": "walls: [{path: [[2.05, -3], [2.05, 3]]}]\n",
    "box": "furniture: [{name: box, box: [1, -0.5, 2, 0.7], turn: 20 deg, height: 40 cm}]\n",
    "corner": "walls: [{path: [[1.5, -2], [1.5, 0.6], [-2, 0.6]]}]\n",
    "overhang": "furniture: [{name: shelf, box: [1, -1, 2, 1], underside: 50 cm, height: 60 cm}]\n",
}


class Cameras:
    """Opens cameras and closes them after the test."""

    def __init__(self) -> None:
        self._open: list[RgbdCamera] = []

    def __call__(self, scene: Scene, seed: int = 0, **options: Any) -> RgbdCamera:
        model, data, surroundings = compiled(scene)
        for step in range(0, 1500, 5):
            surroundings.settle(data, step, -9.0, -9.0)
        settings = {"world": "w.yaml", "camera": "320x240", "camera_mount": MOUNT.tolist(), **options}
        camera = RgbdCamera(
            model, surroundings, MujocoOptions.model_validate(settings), np.random.default_rng(seed)
        )
        self._open.append(camera)
        return camera

    def close(self) -> None:
        for camera in self._open:
            camera.close()


@pytest.fixture(name="cameras")
def _cameras() -> Iterator[Cameras]:
    cameras = Cameras()
    yield cameras
    cameras.close()


def image_of(camera: RgbdCamera, course: Course, seconds: float = 0.2) -> RgbdFrame:
    return camera.measure(track_of(course, seconds))[-1]


def exact_depths(scene: Scene, frame: RgbdFrame, course: Course) -> np.ndarray:
    """(H, W) by the prisms of the world file, its edge and floor."""
    plan = scene.world.plan
    assert plan is not None
    x0, y0, x1, y1 = plan.bounds
    edges = [
        (x0 - 1, y0 - 1, x1 + 1, y0),
        (x0 - 1, y1, x1 + 1, y1 + 1),
        (x0 - 1, y0, x0, y1),
        (x1, y0, x1 + 1, y1),
    ]
    prisms = [Prism(solid.corners, solid.low_m, solid.height_m) for solid in (*plan.solids, *plan.overhangs)]
    prisms += [Prism(np.array([(a, b), (c, b), (c, d), (a, d)]), 0.0, 2.5) for a, b, c, d in edges]
    rows, cols = frame.depth_m.shape
    u, v = np.meshgrid(np.arange(cols), np.arange(rows))
    rays = np.stack(
        ((u - frame.cx) / frame.fx, (v - frame.cy) / frame.fy, np.ones_like(u, dtype=float)), axis=-1
    )
    x, y, *angles = course(frame.stamp_s)
    turn = rotation(*angles)
    lengths = np.linalg.norm(rays, axis=-1, keepdims=True)
    directions = (rays / lengths).reshape(-1, 3) @ (turn @ frame.T_base_sensor[:3, :3]).T
    origin = turn @ frame.T_base_sensor[:3, 3] + (x, y, 0.0)
    ranges = Scene3(prisms).cast(np.tile(origin, (len(directions), 1)), directions, 20.0)
    return ranges.reshape(rows, cols) / lengths[..., 0]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("size", ["320x240", "640x480"])
def test_depth_is_that_of_the_drawn_solids(tmp_path: Path, cameras: Cameras, name: str, size: str) -> None:
    scene = scene_of(tmp_path, HALL + SCENES[name])
    course = at_rest(0.1, -0.2, 0.3, 0.07, -0.05)
    frame = image_of(cameras(scene, noise=False, camera=size), course)
    expected = exact_depths(scene, frame, course)
    known = np.isfinite(frame.depth_m) & np.isfinite(expected)
    assert known.mean() > 0.7
    # a pixel whose middle is on an edge may go by it on either side
    assert (np.abs(frame.depth_m - expected)[known] < 1e-3).mean() > 0.998
    assert frame.T_base_sensor[:3, 3] == pytest.approx(MOUNT)


def test_an_image_is_taken_from_where_the_robot_was_at_its_stamp(tmp_path: Path, cameras: Cameras) -> None:
    scene = scene_of(tmp_path, HALL + SCENES["corner"])
    camera = cameras(scene, noise=False)

    def course(time_s: float) -> tuple[float, float, float, float, float]:
        return (0.4 * time_s, 0.0, 0.5 * time_s, 0.05 * math.sin(5.0 * time_s), 0.0)

    frames = camera.measure(track_of(course, 0.7))
    assert [frame.stamp_s for frame in frames] == pytest.approx([0.2, 0.4, 0.6])
    for frame in frames:
        expected = exact_depths(scene, frame, course)
        known = np.isfinite(frame.depth_m) & np.isfinite(expected)
        assert (np.abs(frame.depth_m - expected)[known] < 1e-3).mean() > 0.998


def test_depth_ends_at_its_limits_and_there_is_none_in_the_sky(tmp_path: Path, cameras: Cameras) -> None:
    scene = scene_of(tmp_path, "bounds: [-30, -30, 30, 30]\n" + SCENES["plane"])
    frame = image_of(cameras(scene, noise=False, camera_range=1.5), at_rest(0.0, 0.0))
    assert np.nanmax(frame.depth_m) <= 1.5
    assert np.isnan(frame.depth_m[:120]).all()
    close = image_of(cameras(scene, noise=False), at_rest(1.8, 0.0))
    assert np.isnan(close.depth_m).all()
    assert not np.isinf(close.depth_m).any()


def test_the_noise_of_depth_grows_with_its_square(tmp_path: Path, cameras: Cameras) -> None:
    scene = scene_of(tmp_path, HALL + SCENES["plane"])
    for x, away in ((0.95, 1.0), (-1.05, 3.0)):
        frame = image_of(cameras(scene, depth_noise=0.003), at_rest(x, -0.02))
        wall = frame.depth_m[60:120, 80:240]
        assert wall.mean() == pytest.approx(away, abs=0.002)
        assert wall.std() == pytest.approx(0.003 * away**2, rel=0.05)


def test_people_and_doors_are_seen_as_they_are_at_the_stamp(tmp_path: Path, cameras: Cameras) -> None:
    scene = scene_of(
        tmp_path,
        HALL
        + "walls: [{path: [[2.5, -3], [2.5, 3]]}]\n"
        + "doors: [{name: exit, at: [2.5, 0.0], width: 2, shut: [[0.5, 2]]}]\n"
        + "people: [{name: ada, route: [[1.5, -0.6], [1.5, 1.4]], speed: 1, radius: 0.2}]\n",
    )
    for frame in cameras(scene, noise=False).measure(track_of(at_rest(0.0, 0.0), 1.3)):
        row = frame.depth_m[100]
        bearing = (np.arange(320) - frame.cx) / frame.fx
        y = MOUNT[1] - bearing * row
        on_ada = row < 1.6
        assert np.hypot(row[on_ada] + 0.05 - 1.5, y[on_ada] - frame.stamp_s + 0.6) == pytest.approx(
            0.2, abs=2e-3
        )
        through = row[np.abs(y / row) < 0.3][~on_ada[np.abs(y / row) < 0.3]]
        assert through == pytest.approx(2.43 if frame.stamp_s > 0.5 else 3.95, abs=2e-3)


def test_what_is_behind_glass_is_seen_paler(tmp_path: Path, cameras: Cameras) -> None:
    edge = HALL + "walls: [{path: [[1.05, -2], [1.05, 0]], material: %s}]\n"
    glass, matt = (
        image_of(cameras(scene_of(tmp_path, edge % look), noise=False), at_rest(0.0, 0.0)).image.astype(float)
        for look in ("glass", "matt")
    )
    behind, beside = np.s_[60:110, 200:300], np.s_[60:110, 20:120]
    assert np.abs(glass[behind] - matt[behind]).mean() > 5.0
    assert 0.2 * glass[beside].std() < glass[behind].std() < 0.95 * glass[beside].std()


def test_features_of_a_wall_match_from_elsewhere_and_those_of_another_wall_do_not(
    tmp_path: Path, cameras: Cameras
) -> None:
    orb = cv2.ORB.create(nfeatures=500)

    def features(x: float, y: float, yaw: float) -> Any:
        camera = cameras(scene_of(tmp_path, HALL), noise=False)
        return orb.detectAndCompute(image_of(camera, at_rest(x, y, yaw)).grey, None)

    def inliers(one: Any, other: Any) -> int:
        matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(one[1], other[1])
        a = np.float32([one[0][match.queryIdx].pt for match in matches])
        b = np.float32([other[0][match.trainIdx].pt for match in matches])
        _, mask = cv2.findHomography(a, b, cv2.RANSAC, 3.0)
        return 0 if mask is None else int(mask.sum())

    here, beside, elsewhere = (
        features(*pose) for pose in ((1.0, 0.0, 0.0), (1.0, 0.25, 0.1), (-1.0, 0.0, math.pi))
    )
    assert inliers(here, beside) > 60
    assert inliers(here, elsewhere) < 25


def test_the_same_seed_gives_the_same_images(tmp_path: Path, cameras: Cameras) -> None:
    one, other = (
        image_of(cameras(scene_of(tmp_path, HALL), seed=3), at_rest(0.3, 0.1, 0.2)) for _ in range(2)
    )
    assert np.array_equal(one.image, other.image)
    assert np.array_equal(one.depth_m, other.depth_m, equal_nan=True)


def test_a_missing_library_is_one_line_with_the_packages_to_install(
    tmp_path: Path, cameras: Cameras, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    monkeypatch.setitem(sys.modules, "mujoco.osmesa", None)
    with pytest.raises(UserError, match="apt-get install libosmesa6, or say camera: off") as refused:
        cameras(scene_of(tmp_path, HALL))
    assert "\n" not in str(refused.value)
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    with pytest.raises(UserError, match="MUJOCO_GL is glfw; expected egl or osmesa"):
        cameras(scene_of(tmp_path, HALL))


def test_a_camera_that_nobody_closed_does_not_crash_the_end_of_the_process(tmp_path: Path) -> None:
    code = (
        "from pathlib import Path; import numpy as np\n"
        "from tests.drivers.test_mujoco_camera import *\n"
        f"camera = Cameras()(scene_of(Path({str(tmp_path)!r}), HALL))\n"
        "print(image_of(camera, at_rest(0.0, 0.0)).image.shape)\n"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=root,
        env={**os.environ, "PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "(240, 320, 3)\n", "")

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

os.environ.setdefault("MUJOCO_GL", "egl")
pytest.importorskip("mujoco")

from explore_bt_drivers.mujoco.lidar import VelodyneLike  # after the skip
from explore_bt_drivers.mujoco.lidar.caster import best_caster
from explore_bt_drivers.mujoco.lidar.embree import EmbreeCaster
from explore_bt_drivers.mujoco.lidar.multi_ray import MultiRayCaster
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.scene import Scene

from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.types import PointCloud

from .mujoco_scenes import Course, at_rest, compiled, rotation, scene_of, track_of

CASTERS = pytest.mark.parametrize("caster", [EmbreeCaster, MultiRayCaster])
MOUNT = np.array([0.02, 0.0, 0.5])
HALL = "bounds: [-4, -3, 4, 3]\n"
SCENES = {
    "plane": "walls: [{path: [[2.05, -3], [2.05, 3]]}]\n",
    "box": "furniture: [{name: box, box: [1, -0.5, 2, 0.7], turn: 20 deg, height: 40 cm}]\n",
    "corner": "walls: [{path: [[1.5, -2], [1.5, 1.2], [-2, 1.2]]}]\n",
    "overhang": "furniture: [{name: shelf, box: [1, -1, 2, 1], underside: 50 cm, height: 60 cm}]\n",
    "round": "furniture: [{name: plant, circle: [-1.5, 0.3, 0.4]}]\n",
}


def lidar_in(scene: Scene, caster: type = EmbreeCaster, seed: int = 0, **options: Any) -> VelodyneLike:
    settings = {"world": "w.yaml", "lidar_mount": MOUNT.tolist(), "lidar_range": 8.0, **options}
    _, data, surroundings = compiled(scene)
    for step in range(0, 1500, 5):
        surroundings.settle(data, step, -9.0, -9.0)
    return VelodyneLike(
        surroundings, MujocoOptions.model_validate(settings), np.random.default_rng(seed), caster
    )


def last_sweep(lidar: VelodyneLike, course: Course, seconds: float = 0.1) -> PointCloud:
    return lidar.measure(track_of(course, seconds))[-1]


def exact_ranges(scene: Scene, cloud: PointCloud, course: Course) -> np.ndarray:
    """(N,) by the prisms of the world file, its edge and floor; every point from its own column's pose."""
    plan = scene.world.plan
    assert plan is not None
    x0, y0, x1, y1 = plan.bounds
    edges = [
        (x0 - 1, y0 - 1, x1 + 1, y0),
        (x0 - 1, y1, x1 + 1, y1 + 1),
        (x0 - 1, y0, x0, y1),
        (x1, y0, x1 + 1, y1),
    ]
    top = max((solid.height_m for solid in plan.solids), default=0.0)
    prisms = [Prism(solid.corners, solid.low_m, solid.height_m) for solid in (*plan.solids, *plan.overhangs)]
    prisms += [Prism(np.array([(a, b), (c, b), (c, d), (a, d)]), 0.0, max(top, 2.5)) for a, b, c, d in edges]
    columns = len(cloud.times_s) // 16
    azimuth = np.repeat(-math.pi + 2 * math.pi / columns * np.arange(columns), 16)
    up = np.tile(np.radians(np.linspace(-15, 15, 16)), columns)
    beams = np.column_stack((np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up)))
    origins, directions = np.empty_like(beams), np.empty_like(beams)
    for i, time_s in enumerate(cloud.stamp_s + cloud.times_s):
        x, y, *angles = course(time_s)
        turn = rotation(*angles)
        origins[i], directions[i] = turn @ MOUNT + (x, y, 0.0), turn @ beams[i]
    return Scene3(prisms).cast(origins, directions, 8.0)


@CASTERS
@pytest.mark.parametrize("name", SCENES)
def test_ranges_are_those_of_the_drawn_solids(tmp_path: Path, caster: type, name: str) -> None:
    scene = scene_of(tmp_path, HALL + SCENES[name])
    course = at_rest(0.1, -0.2, 0.4, 0.07, -0.05)
    cloud = last_sweep(lidar_in(scene, caster, noise=False, columns=180), course)
    expected = exact_ranges(scene, cloud, course)
    found = np.linalg.norm(cloud.points.astype(np.float64), axis=1)
    assert np.isfinite(found).sum() > 2000
    agree = np.abs(found - np.where(np.isfinite(expected), expected, math.nan)) < 1e-3
    # a ray along an edge may go by it on either side
    assert (agree | (np.isnan(found) & np.isinf(expected))).mean() > 0.998


@CASTERS
def test_each_column_is_cast_from_the_pose_at_its_own_time(tmp_path: Path, caster: type) -> None:
    scene = scene_of(tmp_path, HALL + SCENES["corner"])

    def course(time_s: float) -> tuple[float, float, float, float, float]:
        return (0.5 * time_s, -0.1, 1.5 * time_s, 0.1 * math.sin(6 * time_s), 0.05 * math.cos(5 * time_s))

    cloud = last_sweep(lidar_in(scene, caster, noise=False, columns=180), course, 0.4)
    found = np.linalg.norm(cloud.points.astype(np.float64), axis=1)
    expected = exact_ranges(scene, cloud, course)
    known = np.isfinite(found) & np.isfinite(expected)
    assert known.mean() > 0.8
    assert (np.abs(found - expected)[known] < 1e-3).mean() > 0.995


def test_the_last_column_is_measured_at_the_stamp_and_all_are_evenly_apart(tmp_path: Path) -> None:
    cloud = last_sweep(lidar_in(scene_of(tmp_path, HALL)), at_rest(0.0, 0.0), 0.2)
    assert cloud.stamp_s == 0.2
    assert cloud.points.shape == (14400, 3)
    assert cloud.times_s.shape == (14400,)
    assert cloud.times_s.max() == 0.0
    steps = np.diff(np.unique(cloud.times_s))
    assert steps == pytest.approx(0.1 / 900)
    assert len(steps) == 899
    azimuth = np.arctan2(*cloud.points[16 * 225, 1::-1])
    assert azimuth == pytest.approx(-math.pi / 2, abs=1e-6)


def test_a_deskewed_cloud_of_a_spin_lies_on_the_walls_within_noise(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, "bounds: [-3, -2, 3, 2]\n")
    cloud = last_sweep(lidar_in(scene), lambda t: (0.3, 0.2, 1.5 * t, 0.0, 0.0), 1.0)
    yaw = 1.5 * (cloud.stamp_s + cloud.times_s)
    known = np.isfinite(cloud.points[:, 0])
    beams = cloud.points[known].astype(np.float64) + MOUNT
    c, s = np.cos(yaw[known]), np.sin(yaw[known])
    stood = np.array((0.3, 0.2))
    places = stood + np.column_stack((c * beams[:, 0] - s * beams[:, 1], s * beams[:, 0] + c * beams[:, 1]))
    high = beams[:, 2] > 0.1
    gaps = np.min(np.abs(np.abs(places[high]) - (3.0, 2.0)), axis=1)
    along = np.linalg.norm(cloud.points[known][high], axis=1)
    assert np.sqrt(np.mean(gaps**2)) < 0.02
    assert np.quantile(gaps, 0.999) < 4 * 0.02
    skewed = cloud.points[known][high][:, :2].astype(np.float64)
    assert along.max() < 8.0
    end = 1.5 * cloud.stamp_s
    back = np.array([[math.cos(end), math.sin(end)], [-math.sin(end), math.cos(end)]])
    turned = stood + skewed @ back
    assert np.median(np.min(np.abs(np.abs(turned) - (3.0, 2.0)), axis=1)) > 0.02


@CASTERS
def test_glass_lets_beams_pass_and_mirrors_reflect_them(tmp_path: Path, caster: type) -> None:
    pane = "walls: [{path: [[2.05, -1], [2.05, 1]], material: %s}]\n"
    azimuth = 16 * 90 + 8  # a little above level, straight ahead, of 180 columns
    ahead = {}
    for material in ("matt", "glass", "mirror"):
        lidar = lidar_in(scene_of(tmp_path, HALL + pane % material), caster, noise=False, columns=180)
        ahead[material] = np.linalg.norm(last_sweep(lidar, at_rest(0.0, 0.0)).points, axis=1)[azimuth]
    level = math.cos(math.radians(1.0))
    assert ahead["matt"] * level == pytest.approx(1.98, abs=1e-3)
    assert ahead["glass"] * level == pytest.approx(3.98, abs=1e-3)
    assert ahead["mirror"] * level == pytest.approx(1.98 + 2.0 + 4.0, abs=1e-3)


def test_people_and_doors_are_seen_where_they_are_at_each_columns_time(tmp_path: Path) -> None:
    scene = scene_of(
        tmp_path,
        HALL
        + "rooms: [{name: closet, box: [-3.5, -1, -1.5, 1]}]\n"
        + "doors: [{name: closet door, at: [-1.5, 0], width: 0.9, shut: [[1.05, 2]]}]\n"
        + "people: [{name: ada, route: [[2, -2], [2, 2]], speed: 2, radius: 0.3}]\n",
    )
    lidar = lidar_in(scene, noise=False)
    clouds = lidar.measure(track_of(at_rest(0.0, 0.0), 1.5))
    for cloud in clouds:
        ahead = cloud.points[16 * 450 + 8 :: 16][:400].astype(np.float64) + MOUNT
        on_ada = (np.abs(ahead[:, 0] - 2.0) < 1.0) & (np.abs(ahead[:, 1]) < 2.5)
        times = (cloud.stamp_s + cloud.times_s[16 * 450 + 8 :: 16][:400])[on_ada]
        away = np.hypot(ahead[on_ada, 0] - 2.0, ahead[on_ada, 1] - (2.0 * times - 2.0))
        assert away == pytest.approx(0.3, abs=1e-3)
    # columns turn from astern: those that look into the closet are the first and the last of a sweep
    sweep = clouds[10]  # ends at 1.1 s, the door shuts at 1.05 s
    level = np.abs(sweep.points.reshape(900, 16, 3)[:, 8].astype(np.float64) + MOUNT)
    assert level[5, 0] == pytest.approx(3.45, abs=1e-3)
    assert level[895, 0] == pytest.approx(1.48, abs=1e-3)


def test_a_person_has_shoulders_and_a_head(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, HALL + "people: [{name: ada, route: [[1, 0], [1, 0.1]], begin: 1 h}]\n")
    lidar = lidar_in(scene, noise=False, lidar_mount=[0.0, 0.0, 1.6])
    points = last_sweep(lidar, at_rest(0.0, 0.0)).points.astype(np.float64) + np.array((0.0, 0.0, 1.6))
    ahead = points[np.hypot(points[:, 0] - 1.0, points[:, 1]) < 0.2501]
    on_head = np.abs(np.linalg.norm(ahead - (1.0, 0.0, 1.63), axis=1) - 0.13) < 1e-3
    on_shoulders = np.abs(ahead[:, 2] - 1.5) < 1e-3
    on_side = np.abs(np.hypot(ahead[:, 0] - 1.0, ahead[:, 1]) - 0.25) < 1e-3
    assert (on_head | on_shoulders | on_side | (ahead[:, 2] < 1e-3)).all()
    assert min(on_head.sum(), on_shoulders.sum(), on_side.sum()) > 5


def test_noise_and_drop_outs_are_as_large_as_asked(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, HALL)
    exact = last_sweep(lidar_in(scene, noise=False), at_rest(0.0, 0.0)).points
    noisy = last_sweep(lidar_in(scene, range_noise=0.02, dropout=0.1), at_rest(0.0, 0.0)).points
    lost = np.isnan(noisy[:, 0]) & ~np.isnan(exact[:, 0])
    assert lost.mean() == pytest.approx(0.1, abs=0.01)
    off = np.linalg.norm(noisy[~np.isnan(noisy[:, 0])], axis=1) - np.linalg.norm(
        exact[~np.isnan(noisy[:, 0])], axis=1
    )
    assert np.nanstd(off) == pytest.approx(0.02, rel=0.05)
    assert np.array_equal(np.isnan(noisy).any(axis=1), np.isnan(noisy).all(axis=1))
    assert not np.isinf(noisy).any()


def test_beams_that_meet_nothing_and_those_that_are_covered_are_invalid(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, "bounds: [-40, -40, 40, 40]\n")
    cloud = last_sweep(lidar_in(scene, noise=False, lidar_range=5.0), at_rest(0.0, 0.0))
    up = np.linalg.norm(cloud.points.reshape(900, 16, 3), axis=2)
    assert np.isnan(up[:, 8:]).all()
    assert up[:, 0] == pytest.approx(0.5 / math.sin(math.radians(15.0)), abs=1e-3)
    blocked = last_sweep(lidar_in(scene, noise=False, lidar_range=5.0, lidar_blocked=0.3), at_rest(0.0, 0.0))
    is_covered = np.isnan(blocked.points.reshape(900, 16, 3)[:, 0, 0])
    assert is_covered.mean() == pytest.approx(0.3, abs=0.002)
    assert is_covered[:130].all()
    assert is_covered[-130:].all()


def test_the_same_seed_gives_the_same_sweeps_however_they_are_asked_for(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, HALL)
    course: Course = lambda t: (0.2 * t, 0.0, t, 0.0, 0.0)  # noqa: E731  # one line says it
    whole = lidar_in(scene, seed=5).measure(track_of(course, 0.3))
    lidar = lidar_in(scene, seed=5)
    cut = [cloud for end in (0.05, 0.15, 0.3) for cloud in lidar.measure(track_of(course, end))]
    assert [cloud.stamp_s for cloud in cut] == [cloud.stamp_s for cloud in whole]
    for one, other in zip(whole, cut, strict=True):
        assert np.array_equal(one.points, other.points, equal_nan=True)


def test_without_embree_mujoco_casts_the_rays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    parts = [scene_of(tmp_path, HALL).fixed]
    assert isinstance(best_caster(parts), EmbreeCaster)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert isinstance(best_caster(parts), MultiRayCaster)

from __future__ import annotations

import math

import numpy as np
import pytest
from explore_bt_slam.sight import Sight, SightMaker
from explore_bt_slam.sight_match import match_sights
from explore_bt_slam.sight_store import SightStore

from explore_bt.testing.slam_camera import RoomCamera
from explore_bt.testing.slam_room import Room
from explore_bt.types import Pose2, RgbdFrame

HOME = Pose2(-1.0, 0.0, 0.3)


def camera(first_texture: int = 0) -> RoomCamera:
    room = Room.furnished()
    return RoomCamera(room, np.arange(first_texture, first_texture + len(room.segments)))


def sight(cam: RoomCamera, pose: Pose2) -> Sight:
    return SightMaker().sight(cam.frame(0.0, pose), Pose2.identity())


def noise(seed: int, count: int = 100) -> Sight:
    rng = np.random.default_rng(seed)
    points = rng.uniform(1.0, 3.0, (count, 3)).astype(np.float32)
    return Sight(rng.integers(0, 256, (count, 32), dtype=np.uint8), points, np.full(count, 0.01, np.float32))


def spoilt(descriptors: np.ndarray, bits: int, seed: int) -> np.ndarray:
    """The same descriptors with so many bits turned over in each."""
    rng = np.random.default_rng(seed)
    unpacked = np.unpackbits(descriptors, axis=1)
    for row in unpacked:
        row[rng.choice(256, bits, replace=False)] ^= 1
    return np.packbits(unpacked, axis=1)


def test_features_lie_on_the_walls() -> None:
    cam = camera()
    found = sight(cam, HOME)
    assert 100 <= found.points.shape[0] <= 200
    on_map = HOME.apply(found.points[:, :2])
    assert (cam.room.distance(on_map) < 4.0 * found.sigmas_m + 0.02).all()
    assert ((found.points[:, 2] > -0.05) & (found.points[:, 2] < 2.55)).all()


def test_a_sight_is_told_in_the_frame_of_its_keyframe() -> None:
    frame, maker, moved = camera().frame(0.0, HOME), SightMaker(), Pose2(0.3, -0.1, 0.4)
    here, there = maker.sight(frame, Pose2.identity()), maker.sight(frame, moved)
    assert np.allclose(moved.apply(here.points[:, :2]), there.points[:, :2], atol=1e-5)
    assert np.array_equal(here.points[:, 2], there.points[:, 2])


@pytest.mark.parametrize("what", ["black", "no depth", "noise"])
def test_an_image_that_shows_nothing_gives_no_features_in_space(what: str) -> None:
    good = camera().frame(0.0, HOME)
    image, depth = good.image, good.depth_m
    if what == "black":
        image = np.zeros_like(image)
    elif what == "no depth":
        depth = np.full_like(depth, np.nan)
    else:
        depth = np.random.default_rng(0).uniform(0.5, 6.0, depth.shape).astype(np.float32)
    frame = RgbdFrame(0.0, image, depth, good.fx, good.fy, good.cx, good.cy, good.T_base_sensor)
    found = SightMaker().sight(frame, Pose2.identity())
    assert found.points.shape[0] < 15
    assert match_sights(found, found) is None


@pytest.mark.parametrize("step", [(0.3, 0.1, 0.1), (0.5, -0.1, 0.2), (0.6, 0.3, 0.3), (-0.5, 0.0, -0.4)])
def test_the_motion_between_two_images_is_found_within_its_covariance(
    step: tuple[float, float, float],
) -> None:
    cam, truth = camera(), Pose2(*step)
    match = match_sights(sight(cam, HOME), sight(cam, HOME.compose(truth)))
    assert match is not None
    error = truth.between(match.relative).as_array()
    assert math.hypot(error[0], error[1]) < 0.05
    assert float(error @ np.linalg.solve(match.covariance, error)) < 16.3


def test_half_of_the_matches_may_be_wrong() -> None:
    truth, old, rng = Pose2(0.7, -0.4, 2.0), noise(1, 80), np.random.default_rng(2)
    flat = truth.inverse().apply(old.points[:, :2])
    points = np.column_stack((flat, old.points[:, 2])).astype(np.float32)
    points[:40] = rng.uniform(1.0, 3.0, (40, 3))
    match = match_sights(old, Sight(spoilt(old.descriptors, 30, 3), points, old.sigmas_m))
    assert match is not None
    assert match.inliers >= 40
    assert truth.distance_to(match.relative) < 0.005


def test_images_of_other_textures_do_not_match() -> None:
    assert match_sights(sight(camera(0), HOME), sight(camera(100), HOME)) is None


def test_the_index_counts_no_feature_that_a_slow_search_does_not() -> None:
    store, sights = SightStore(), [noise(seed) for seed in range(5)]
    for number, kept in enumerate(sights):
        store.add(number, kept)
    query = Sight(spoilt(sights[3].descriptors, 25, 9), sights[3].points, sights[3].sigmas_m)
    votes = store.votes(query)
    bits = np.unpackbits(query.descriptors, axis=1).astype(np.int64)
    for number, kept in enumerate(sights):
        others = np.unpackbits(kept.descriptors, axis=1).astype(np.int64)
        distance = (bits[:, None, :] != others[None, :, :]).sum(axis=2)
        slow = int((distance.min(axis=1) <= 50).sum())
        assert votes[number] <= slow
        if slow == 100:
            assert votes[number] > 40
    assert int(np.argmax(votes)) == 3


def test_memory_ends_at_the_capacity_and_old_places_stay_among_the_kept() -> None:
    store = SightStore(capacity=16)
    for number in range(100):
        store.add(number, noise(number))
        assert len(store.sights) <= 16
        assert int(np.argmax(store.votes(noise(number)))) == len(store.sights) - 1
    assert store.keyframes[0] == 0
    assert store.keyframes == sorted(store.keyframes)
    assert store.votes(noise(0))[0] == 100


def test_a_store_comes_back_from_its_arrays() -> None:
    store, again = SightStore(), SightStore()
    for number in range(4):
        store.add(10 * number, noise(number, 30 + number))
    again.restore(store.arrays())
    assert again.keyframes == store.keyframes
    assert np.array_equal(again.votes(noise(2)), store.votes(noise(2)))
    empty = SightStore()
    empty.restore(SightStore().arrays())
    assert not empty.sights

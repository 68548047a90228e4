"""/tf without tf2: bytes, buffer, look-ups."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import math
from contextlib import suppress

import numpy as np
import pytest
from explore_bt_ros2.transforms.buffer import TransformBuffer
from explore_bt_ros2.transforms.message import decode, encode
from explore_bt_ros2.transforms.transform import Transform
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation, Slerp

from explore_bt.types import Pose2

STORE = get_typestore(Stores.ROS2_JAZZY)
KIND = "tf2_msgs/msg/TFMessage"

names = st.text("abcdefgh_0123ü", min_size=1, max_size=12)
metres = st.floats(-100.0, 100.0)
angles = st.floats(-3.0, 3.0)


@st.composite
def transforms(draw) -> Transform:
    turn = Rotation.from_euler("xyz", [draw(angles), draw(angles), draw(angles)]).as_quat()
    x, y, z, w = turn.tolist()
    stamp_s = draw(st.integers(0, 2_000_000)) * 0.25
    shift = (draw(metres), draw(metres), draw(metres))
    return Transform(stamp_s, draw(names), draw(names), shift, (x, y, z, w))


def as_rosbags(listed):
    types = STORE.types
    vector, quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]
    return types[KIND](
        transforms=[
            types["geometry_msgs/msg/TransformStamped"](
                header=types["std_msgs/msg/Header"](
                    stamp=types["builtin_interfaces/msg/Time"](
                        math.floor(each.stamp_s), round(1e9 * (each.stamp_s % 1.0))
                    ),
                    frame_id=each.parent,
                ),
                child_frame_id=each.child,
                transform=types["geometry_msgs/msg/Transform"](vector(*each.shift), quaternion(*each.turn)),
            )
            for each in listed
        ]
    )


@settings(suppress_health_check=[HealthCheck.too_slow])  # on a machine with other work
@given(st.lists(transforms(), max_size=4))
def test_the_bytes_are_those_of_another_implementation(listed):
    theirs = bytes(STORE.serialize_cdr(as_rosbags(listed), KIND, little_endian=True))
    ours = encode(listed)
    assert ours == theirs[: len(ours)]
    assert not any(theirs[len(ours) :])  # padding


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(transforms(), max_size=4), st.booleans())
def test_bytes_of_another_implementation_are_understood(listed, little):
    data = bytes(STORE.serialize_cdr(as_rosbags(listed), KIND, little_endian=little))
    for ours, theirs in zip(decode(data), listed, strict=True):
        assert (ours.stamp_s, ours.parent, ours.child) == (theirs.stamp_s, theirs.parent, theirs.child)
        np.testing.assert_allclose(ours.matrix(), theirs.matrix(), atol=1e-12)


@given(st.binary(max_size=200))
def test_damaged_bytes_are_refused_in_words(data):
    with suppress(ValueError):  # nothing else comes out of it
        decode(data)


@given(st.lists(transforms(), min_size=1, max_size=2), st.integers(1, 60))
def test_a_message_that_is_cut_off_is_refused(listed, missing):
    with pytest.raises(ValueError, match="TFMessage"):
        decode(encode(listed)[:-missing])


@given(transforms(), transforms(), st.floats(0.0, 1.0))
def test_between_two_stamps_it_is_as_scipy_interpolates(first, second, share):
    first = Transform(1.0, "odom", "base_link", first.shift, first.turn)
    second = Transform(2.0, "odom", "base_link", second.shift, second.turn)
    buffer = TransformBuffer()
    buffer.learn([first, second])
    turns = Rotation.from_quat([first.turn, second.turn])
    expected = Slerp([1.0, 2.0], turns)(1.0 + share).as_matrix()
    found = buffer.find("odom", "base_link", 1.0 + share)
    assert found is not None
    if abs(np.dot(first.turn, second.turn)) > 1e-3:  # half a turn apart either way round is right
        np.testing.assert_allclose(found[:3, :3], expected, atol=1e-6)
    shift = np.array(first.shift) + share * (np.array(second.shift) - np.array(first.shift))
    np.testing.assert_allclose(found[:3, 3], shift, atol=1e-9)


@given(transforms(), transforms(), transforms())
def test_frames_of_one_tree_are_found_from_either_side(one, two, three):
    buffer = TransformBuffer()
    buffer.learn_fixed([Transform(0.0, "base_link", "laser", one.shift, one.turn)])
    buffer.learn([Transform(5.0, "odom", "base_link", two.shift, two.turn)])
    buffer.learn([Transform(6.0, "odom", "camera", three.shift, three.turn)])
    expected = np.linalg.inv(three.matrix()) @ two.matrix() @ one.matrix()
    found = buffer.find("camera", "laser")
    assert found is not None
    np.testing.assert_allclose(found, expected, atol=1e-6)
    back = buffer.find("laser", "camera")
    assert back is not None
    np.testing.assert_allclose(back @ found, np.eye(4), atol=1e-6)


def test_what_hangs_in_no_common_tree_is_not_found():
    buffer = TransformBuffer()
    buffer.learn([Transform.planar(1.0, "map", "odom", Pose2(1, 2, 0.3))])
    assert buffer.find("map", "base_link") is None
    assert buffer.newest_s("map", "base_link") is None


def test_a_ring_of_frames_ends():
    buffer = TransformBuffer()
    buffer.learn(
        [Transform.planar(1.0, "a", "b", Pose2.identity()), Transform.planar(1.0, "b", "a", Pose2.identity())]
    )
    assert buffer.find("c", "a") is None


def test_the_stalest_moving_link_tells_how_old_a_way_is():
    buffer = TransformBuffer()
    buffer.learn_fixed([Transform.planar(0.0, "base_link", "laser", Pose2(0.1, 0, 0))])
    assert buffer.newest_s("base_link", "laser") == math.inf
    buffer.learn([Transform.planar(3.0, "map", "odom", Pose2.identity())])
    buffer.learn([Transform.planar(4.0, "odom", "base_link", Pose2.identity())])
    assert buffer.newest_s("map", "laser") == 3.0
    assert buffer.newest_s("odom", "laser") == 4.0
    assert buffer.newest_s("laser", "odom") == 4.0

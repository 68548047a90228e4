"""Keyframes, stretches and fits on the wire."""

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.fleet import Fits, MessageError, decode, encode
from explore_bt.types import STRETCH_KEYFRAMES, Pose2, SharedEdge, SharedKeyframe, SharedStretch


def keyframe(seed: int, count: int = 360) -> SharedKeyframe:
    """A room as a lidar sees it, noise and all."""
    rng = np.random.default_rng(seed)
    angles = np.linspace(-np.pi, np.pi, count, endpoint=False)
    ranges = np.minimum(2.0 / np.maximum(np.abs(np.cos(angles)), 0.3), 4.0) + rng.normal(0.0, 0.01, count)
    return SharedKeyframe(
        seed, 0.1 * seed, 0.5 * seed, ranges[:, None] * np.column_stack((np.cos(angles), np.sin(angles)))
    )


def stretch(seed: int) -> SharedStretch:
    rng = np.random.default_rng(seed)
    number, count = int(rng.integers(0, 50)), int(rng.integers(1, STRETCH_KEYFRAMES + 1))
    edges = []
    for _ in range(int(rng.integers(0, 30))):
        b = number * STRETCH_KEYFRAMES + int(rng.integers(0, count))
        root = rng.normal(0.0, 0.05, (3, 3))
        covariance = root @ root.T + np.eye(3) * 1e-5
        if b:
            relative = Pose2(*rng.uniform(-3.0, 3.0, 3).tolist())
            edges.append(SharedEdge(int(rng.integers(0, b)), b, relative, covariance, bool(rng.integers(2))))
    return SharedStretch(number, rng.uniform(-100.0, 100.0, (count, 3)), tuple(edges))


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(0, 800))
def test_a_keyframe_comes_as_it_was_sent_to_half_a_centimetre(seed: int, count: int) -> None:
    sent = keyframe(seed, count)
    heard = decode(encode(sent))
    assert isinstance(heard, SharedKeyframe)
    assert (heard.number, heard.stamp_s, heard.driven_m) == (sent.number, sent.stamp_s, sent.driven_m)
    assert heard.points.shape == sent.points.shape
    assert np.abs(heard.points - sent.points).max(initial=0.0) <= 0.0025 + 1e-9


def test_a_keyframe_is_a_kilobyte_at_most() -> None:
    """At one a second that is a twentieth of the budget."""
    assert len(encode(keyframe(1))) < 1024


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_a_stretch_comes_as_it_was_sent_to_single_precision(seed: int) -> None:
    sent = stretch(seed)
    heard = decode(encode(sent))
    assert isinstance(heard, SharedStretch)
    assert heard.number == sent.number
    assert np.allclose(heard.poses, sent.poses, atol=1e-4)
    for one, other in zip(heard.edges, sent.edges, strict=True):
        assert (one.a, one.b, one.is_closure) == (other.a, other.b, other.is_closure)
        assert np.allclose(one.relative.as_array(), other.relative.as_array(), atol=1e-5)
        assert np.allclose(one.covariance, other.covariance, rtol=1e-4, atol=1e-7)


def test_fits_come_as_they_were_sent() -> None:
    sent = Fits({"ada": Pose2(1.0, -2.0, 0.5), "böb-2": Pose2(0.0, 0.0, -3.0)})
    assert decode(encode(sent)) == sent
    assert decode(encode(Fits({}))) == Fits({})


@settings(max_examples=150, deadline=None)
@given(kind=st.sampled_from((0, 1, 2)), cut=st.integers(0, 4000), junk=st.binary(max_size=40))
def test_damaged_bytes_are_refused_and_nothing_else_happens(kind: int, cut: int, junk: bytes) -> None:
    whole = encode((keyframe(3), stretch(5), Fits({"ada": Pose2.identity()}))[kind])
    with contextlib.suppress(MessageError):
        decode(whole[: cut % len(whole)] + junk)


def test_constraints_that_end_elsewhere_or_are_no_measurement_are_refused() -> None:
    good = SharedEdge(3, 17, Pose2.identity(), np.eye(3) * 1e-4, is_closure=False)
    poses = np.zeros((2, 3))
    assert decode(encode(SharedStretch(1, poses, (good,))))
    for bad in (
        SharedEdge(3, 18, good.relative, good.covariance, is_closure=False),
        SharedEdge(17, 17, good.relative, good.covariance, is_closure=False),
        SharedEdge(3, 17, good.relative, -good.covariance, is_closure=False),
        SharedEdge(3, 17, Pose2(np.nan, 0.0, 0.0), good.covariance, is_closure=False),
    ):
        with pytest.raises(MessageError):
            decode(encode(SharedStretch(1, poses, (bad,))))

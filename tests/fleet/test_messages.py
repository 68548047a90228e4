import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.fleet import MESSAGE_VERSION, TILE_CELLS, MessageError, Presence, Tile, decode, encode
from explore_bt.types import Doing, Pose2, Twist2

metres = st.floats(-150.0, 150.0)
points = st.lists(st.tuples(st.floats(-20, 20), st.floats(-20, 20)), max_size=40)


def test_what_a_mate_tells_of_itself_is_moved_into_another_map_as_a_whole() -> None:
    stop, ahead = np.array([[1.0, 0.0], [2.0, 0.0]]), np.array([[3.0, 1.0]])
    told = Presence(
        1.0, 1.05, Pose2(1.0, 0.0, 0.0), Twist2(0.3, 0.1), 0.25, 0.5, stop, ahead, ((4.0, 0.0), (0.0, 0.0))
    )
    moved = told.moved(Pose2(10.0, 0.0, np.pi / 2))
    assert moved.T_map_base.as_array() == pytest.approx([10.0, 1.0, np.pi / 2])
    assert moved.stop == pytest.approx(np.array([[10.0, 1.0], [10.0, 2.0]]))
    assert moved.ahead == pytest.approx(np.array([[9.0, 3.0]]))
    assert moved.claims == (pytest.approx((10.0, 4.0)), pytest.approx((10.0, 0.0)))
    assert (moved.stamp_s, moved.twist, moved.doing) == (told.stamp_s, told.twist, told.doing)


@settings(max_examples=60, deadline=None)
@given(
    x=metres,
    y=metres,
    stop=points,
    ahead=points,
    claims=st.lists(st.tuples(metres, metres), max_size=8),
    doing=st.sampled_from(Doing),
    yields=st.integers(-5, 5),
    stamp_s=st.floats(0.0, 1e6),
)
def test_a_presence_comes_as_it_was_sent_to_half_a_centimetre(
    x: float,
    y: float,
    stop: list[tuple[float, float]],
    ahead: list[tuple[float, float]],
    claims: list[tuple[float, float]],
    doing: Doing,
    yields: int,
    stamp_s: float,
) -> None:
    near = [np.array(each).reshape(-1, 2) + np.array([x, y]) for each in (stop, ahead)]
    sent = Presence(
        stamp_s,
        stamp_s + 0.05,
        Pose2(x, y, 1.5),
        Twist2(0.4, -0.2),
        0.25,
        0.5,
        *near,
        tuple(claims),
        doing,
        yields,
    )
    got = decode(encode(sent))
    assert isinstance(got, Presence)
    assert (got.stamp_s, got.binding_s, got.T_map_base) == (sent.stamp_s, sent.binding_s, sent.T_map_base)
    assert (got.doing, got.yields) == (doing, yields)
    assert got.twist.linear_mps == pytest.approx(0.4)
    assert got.stop == pytest.approx(sent.stop, abs=0.0026)
    assert got.ahead == pytest.approx(sent.ahead, abs=0.0026)
    assert np.array(got.claims).reshape(-1, 2) == pytest.approx(np.array(claims).reshape(-1, 2), abs=0.0006)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 1000), place=st.tuples(st.integers(-9999, 9999), st.integers(-9999, 9999)))
def test_a_tile_comes_as_it_was_sent(seed: int, place: tuple[int, int]) -> None:
    cells = np.random.default_rng(seed).choice([-1, 0, 100], (TILE_CELLS, TILE_CELLS)).astype(np.int8)
    got = decode(encode(Tile(seed, 0.05, place, cells)))
    assert isinstance(got, Tile)
    assert (got.revision, got.resolution_m, got.place) == (seed, 0.05, place)
    assert np.array_equal(got.cells, cells)


def test_a_tile_of_a_room_takes_a_few_hundred_bytes() -> None:
    cells = np.full((TILE_CELLS, TILE_CELLS), -1, dtype=np.int8)
    cells[8:50, 5:60] = 0
    cells[[8, 49], 5:60] = cells[8:50, [5, 59]] = 100
    assert len(encode(Tile(1, 0.05, (0, 0), cells))) < 200


@settings(max_examples=200, deadline=None)
@given(junk=st.binary(max_size=400))
def test_junk_is_refused_and_harms_nobody(junk: bytes) -> None:
    for payload in (junk, bytes([MESSAGE_VERSION, 1]) + junk, bytes([MESSAGE_VERSION, 2]) + junk):
        with contextlib.suppress(MessageError):
            assert isinstance(decode(payload), Presence | Tile)


def test_every_cut_of_a_message_is_refused() -> None:
    nowhere = np.zeros((3, 2))
    whole = encode(Presence(1.0, 1.1, Pose2(0, 0, 0), Twist2(), 0.25, 0.5, nowhere, nowhere, ((1.0, 2.0),)))
    for length in range(len(whole)):
        with pytest.raises(MessageError):
            decode(whole[:length])


def test_another_version_is_named() -> None:
    with pytest.raises(MessageError, match=f"version {MESSAGE_VERSION + 1}; this explore-bt"):
        decode(bytes([MESSAGE_VERSION + 1, 1, 0, 0]))

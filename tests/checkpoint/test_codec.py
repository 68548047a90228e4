from __future__ import annotations

import contextlib
import dataclasses
import enum
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from explore_bt.checkpoint import Codec, CodecError
from explore_bt.types import Health, Pose2, Waypoint


@dataclasses.dataclass(frozen=True)
class Nest:
    inside: object
    more: object = ()


class Colour(enum.Enum):
    RED = 1
    BLUE = (2, 3)


CODEC = Codec((Nest, Colour, Health, Pose2, Waypoint))

numbers = st.floats(allow_nan=False)
plain = st.one_of(
    st.none(), st.booleans(), st.integers(), numbers, st.text(st.characters()), st.sampled_from(Colour)
)
keys = st.one_of(st.text(), st.integers(), st.tuples(st.integers(), st.text()))
values = st.recursive(
    plain,
    lambda inner: st.one_of(
        st.lists(inner).map(tuple),
        st.lists(inner),
        st.dictionaries(keys, inner),
        st.frozensets(st.one_of(st.integers(), st.text())),
        st.builds(Nest, inner, inner),
        st.builds(Waypoint, st.builds(Pose2, numbers, numbers, numbers), st.text()),
    ),
    max_leaves=20,
)


@given(values)
def test_every_value_comes_back_as_it_was(value: object) -> None:
    assert CODEC.loads(CODEC.dumps(value)) == value


@given(values)
def test_what_is_written_is_json_of_ascii_in_one_line(value: object) -> None:
    text = CODEC.dumps(value)
    assert text.isascii()
    assert "\n" not in text
    json.loads(text, parse_constant=pytest.fail)


@given(
    arrays.arrays(
        st.sampled_from(["<f8", ">f8", "<f4", "<i8", "|u1", "|b1"]).map(np.dtype),
        arrays.array_shapes(min_dims=0, min_side=0),
    )
)
def test_arrays_come_back_bit_for_bit(array: np.ndarray) -> None:
    found = CODEC.loads(CODEC.dumps(Nest(array))).inside
    assert found.shape == array.shape
    assert np.array_equal(found, array, equal_nan=array.dtype.kind == "f")


@pytest.mark.parametrize("number", [math.inf, -math.inf])
def test_infinity_comes_back(number: float) -> None:
    assert CODEC.loads(CODEC.dumps((number,))) == (number,)


def test_what_is_no_number_comes_back_as_such() -> None:
    assert math.isnan(CODEC.loads(CODEC.dumps(math.nan)))


@pytest.mark.parametrize(
    "value", [object(), print, np.array(["text"], dtype=object), (1, {2: object()}), Codec(()), b"bytes"]
)
def test_a_value_of_no_declared_class_is_refused(value: object) -> None:
    with pytest.raises(CodecError, match="cannot be kept"):
        CODEC.dumps(value)


def test_a_declared_name_does_not_let_another_class_of_that_name_in() -> None:
    other = dataclasses.make_dataclass("Nest", ["inside"], frozen=True)
    with pytest.raises(CodecError, match="nobody has declared"):
        CODEC.dumps(other(1))
    with pytest.raises(TypeError, match="two classes are called Nest"):
        Codec((Nest, other))


def test_text_cannot_ask_for_a_class_that_was_not_declared() -> None:
    with pytest.raises(CodecError, match="Popen is no class"):
        CODEC.loads('{"class":"Popen","fields":{"args":["true"]}}')


@given(st.text())
def test_foreign_text_is_refused_and_never_more(text: str) -> None:
    try:
        json.loads(text)
    except ValueError:
        with pytest.raises(CodecError):
            CODEC.loads(text)


@given(values, st.data())
def test_damaged_text_gives_a_value_or_one_clear_refusal(value: object, data: st.DataObject) -> None:
    text = bytearray(CODEC.dumps(value).encode())
    place = data.draw(st.integers(0, len(text) - 1))
    text[place] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(text)))
    for damaged in (bytes(text), bytes(text[:cut])):
        with contextlib.suppress(CodecError):
            CODEC.loads(damaged)


def test_deep_nesting_is_refused() -> None:
    with pytest.raises(CodecError):
        CODEC.loads("[" * 100_000)

from __future__ import annotations

import enum
import json
from dataclasses import dataclass, fields

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.recording import to_json
from explore_bt.types import Health, Path, Pose2, Waypoint

scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
values = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner) | st.tuples(inner, inner) | st.dictionaries(st.text(), inner) | st.frozensets(scalars)
    ),
    max_leaves=25,
)


class Colour(enum.Enum):
    RED = 1


@dataclass(frozen=True)
class Chain:
    next: object


@settings(deadline=None)
@given(values)
def test_whatever_stands_on_the_blackboard_becomes_strict_json(value):
    json.loads(json.dumps(to_json(value), allow_nan=False))


def test_a_waypoint_names_its_class_and_keeps_every_field():
    waypoint = Waypoint(Pose2(1.0, 2.0, 0.5), "widest sector", 3.25)
    shown = to_json(waypoint)
    assert shown.keys() == {"class"} | {field.name for field in fields(waypoint)}
    assert shown["class"] == "Waypoint"
    assert shown["pose"] == {"class": "Pose2", "x": 1.0, "y": 2.0, "yaw_rad": 0.5}
    assert (shown["reason"], shown["expected_gain_m2"]) == ("widest sector", 3.25)


def test_enums_show_their_value_and_numpy_numbers_are_plain():
    assert to_json([Health.OK, Colour.RED, np.int32(7), np.float32(0.5), np.bool_(True)]) == [
        "ok",
        1,
        7,
        0.5,
        True,
    ]


def test_infinite_and_undefined_numbers_become_words():
    assert to_json((float("inf"), float("-inf"), float("nan"))) == ["inf", "-inf", "nan"]


def test_a_short_array_is_written_out():
    assert to_json(np.arange(6).reshape(2, 3)) == [[0, 1, 2], [3, 4, 5]]


def test_a_long_array_is_told_by_shape_and_range():
    path = to_json(Path(np.zeros((500, 3)), np.linspace(0.3, 2.0, 500)))
    assert path["clearance_m"] == {
        "class": "ndarray",
        "dtype": "float64",
        "shape": [500],
        "min": 0.3,
        "max": 2.0,
    }


def test_a_long_tuple_is_told_by_its_ends():
    assert to_json(tuple(range(1000))) == {"class": "sequence", "length": 1000, "first": 0, "last": 999}


def test_an_endless_chain_ends_at_a_fixed_depth():
    chain: object = None
    for _ in range(5000):
        chain = Chain(chain)
    assert len(json.dumps(to_json(chain))) < 500


def test_of_an_unknown_class_only_the_name_is_told():
    assert to_json(object()) == {"class": "object"}

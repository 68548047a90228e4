import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.units import ANGLE, DURATION, LENGTH, SPEED, parse_quantity


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("0.30 m", LENGTH, 0.30),
        ("30 cm", LENGTH, 0.30),
        ("30cm", LENGTH, 0.30),
        ("-1.5e1 mm", LENGTH, -0.015),
        (2, LENGTH, 2.0),
        ("2", LENGTH, 2.0),
        ("90 deg", ANGLE, math.pi / 2),
        ("90°", ANGLE, math.pi / 2),
        ("2 min", DURATION, 120.0),
        ("3.6 km/h", SPEED, 1.0),
    ],
)
def test_quantities_become_si(text: object, dimension: object, value: float) -> None:
    assert parse_quantity(text, dimension) == pytest.approx(value)


@pytest.mark.parametrize("text", ["3 s", "m", "", "1 m 2", "nan m", "inf", True, None, [1], "1e999 m"])
def test_what_is_not_a_length_is_refused_in_one_sentence(text: object) -> None:
    with pytest.raises(ValueError, match=r"is not a length; write 0\.30 m or 30 cm"):
        parse_quantity(text, LENGTH)


@given(st.floats(-1e6, 1e6), st.sampled_from([("m", 1.0), ("cm", 0.01), ("km", 1000.0)]))
def test_a_written_length_is_read_back(value: float, unit: tuple[str, float]) -> None:
    assert parse_quantity(f"{value!r} {unit[0]}", LENGTH) == pytest.approx(value * unit[1])

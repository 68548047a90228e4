from __future__ import annotations

import numpy as np
import pytest

from explore_bt.types import RgbdFrame


def frame(**changes: object) -> RgbdFrame:
    values: dict[str, object] = {
        "stamp_s": 1.0,
        "image": np.zeros((4, 6), np.uint8),
        "depth_m": np.ones((4, 6), np.float32),
        "fx": 5.0,
        "fy": 5.0,
        "cx": 2.5,
        "cy": 1.5,
        "T_base_sensor": np.eye(4),
    }
    return RgbdFrame(**{**values, **changes})  # type: ignore[arg-type]  # the tests put wrong values in


def test_grey_and_colour_images_are_taken() -> None:
    assert frame().grey.shape == (4, 6)
    assert frame(image=np.zeros((4, 6, 3), np.uint8)).grey.shape == (4, 6)


def test_white_is_white_in_grey() -> None:
    assert (frame(image=np.full((4, 6, 3), 255, np.uint8)).grey == 255).all()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"depth_m": np.ones((4, 5), np.float32)}, r"depth_m is float32 of shape \(4, 5\)"),
        ({"depth_m": np.ones((4, 6), np.float64)}, "depth_m is float64"),
        ({"image": np.zeros((4, 6), np.float32)}, "image is float32"),
        ({"image": np.zeros((4, 6, 4), np.uint8)}, r"image is uint8 of shape \(4, 6, 4\)"),
        ({"T_base_sensor": np.eye(3)}, r"T_base_sensor is float64 of shape \(3, 3\)"),
        ({"fx": 0.0}, "expected fx, fy > 0"),
        ({"cy": np.nan}, "expected fx, fy > 0"),
    ],
)
def test_what_does_not_fit_is_named(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        frame(**changes)


def test_all_faults_come_at_once() -> None:
    with pytest.raises(ValueError, match=r"T_base_sensor.*fx"):
        frame(T_base_sensor=np.eye(3), fx=-1.0)

from __future__ import annotations

import numpy as np
import pytest
from explore_bt_slam.inertial import InertialFilter
from explore_bt_slam.standstill import Standstill

from explore_bt.types import Imu

RATE_HZ = 100


def samples(turn_rps: np.ndarray, push_mps2: np.ndarray, bias_rps: float, seed: int) -> list[Imu]:
    """What an IMU of a robot measures that turns and pushes like this, 100 times a second."""
    rng = np.random.default_rng(seed)
    return [
        Imu(
            k / RATE_HZ,
            (0.0, 0.0, float(turn + bias_rps + rng.normal(0.0, 0.003))),
            (float(push + 0.05 + rng.normal(0.0, 0.03)), float(rng.normal(0.0, 0.03)), 9.81),
        )
        for k, (turn, push) in enumerate(zip(turn_rps, push_mps2, strict=True))
    ]


@pytest.mark.parametrize("bias_rps", [-0.02, 0.0, 0.005])
def test_two_seconds_at_rest_teach_the_bias(bias_rps: float) -> None:
    inertial = InertialFilter()
    for imu in samples(np.zeros(230), np.zeros(230), bias_rps, seed=1):
        inertial.take_imu(imu)
    begin = inertial.motion.yaw_rad
    still = np.full(10 * RATE_HZ, bias_rps)
    for k, rate_rps in enumerate(still):
        inertial.take_imu(Imu((230 + k) / RATE_HZ, (0.0, 0.0, float(rate_rps)), (0.05, 0.0, 9.81)))
    assert abs(inertial.motion.yaw_rad - begin) < 10.0 * 0.001


@pytest.mark.parametrize("rise_rps2", [0.05, 0.3, 2.0])
def test_a_turn_that_begins_slowly_is_not_taken_for_bias(rise_rps2: float) -> None:
    turn_rps = np.maximum(np.arange(400) / RATE_HZ - 1.0, 0.0) * rise_rps2
    standstill = Standstill()
    handed_out = [
        rate for imu in samples(turn_rps, np.zeros(400), 0.004, seed=2) for rate in standstill.rates_rps(imu)
    ]
    assert 60 < len(handed_out) < 140
    assert abs(np.mean(handed_out) - 0.004) < 0.001


def test_a_push_ends_the_standstill_for_good() -> None:
    push = np.concatenate((np.zeros(50), np.full(20, 0.5), np.zeros(200)))
    standstill = Standstill()
    handed_out = [len(standstill.rates_rps(imu)) for imu in samples(np.zeros(270), push, 0.0, seed=3)]
    assert sum(handed_out) > 0
    assert sum(handed_out[50:]) == 0

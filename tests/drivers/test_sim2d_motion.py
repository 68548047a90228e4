import math

import numpy as np
import pytest
import ruckig
from explore_bt_drivers.sim2d.body import Body
from explore_bt_drivers.sim2d.motion import STEP_S
from explore_bt_drivers.world import World, load_world
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, Pose2, Twist2

LIMITS = MotionLimits()
PERIOD = 5


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> World:
    path = tmp_path_factory.mktemp("world") / "field.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [-15, -15, 15, 15]\n")
    return load_world(path)


@pytest.fixture(scope="module")
def hall(tmp_path_factory: pytest.TempPathFactory) -> World:
    path = tmp_path_factory.mktemp("world") / "hall.yaml"
    path.write_text("format: explore-bt-world/1\nrooms: [{name: hall, box: [-0.05, -2.05, 3.05, 2.05]}]\n")
    return load_world(path)


def body_at(world: World, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> Body:
    return Body(world, Pose2(x, y, yaw), 0.25, LIMITS)


def drive(body: Body, twists: list[Twist2], steps: int = PERIOD) -> NDArray[np.float64]:
    """States after every internal step, under one twist per period."""
    first = body.track.last_step
    for period, twist in enumerate(twists, start=1):
        body.command(twist)
        body.advance(first + period * steps)
    return body.track.states[first - body.track.first_step :].copy()


def shaped(targets: list[tuple[float, int]]) -> list[float]:
    """A velocity profile at 20 Hz within the linear limits, by ruckig."""
    generator, given_, out = ruckig.Ruckig(1, 0.05), ruckig.InputParameter(1), ruckig.OutputParameter(1)
    given_.control_interface = ruckig.ControlInterface.Velocity
    given_.max_acceleration, given_.max_jerk = [LIMITS.acceleration_mps2], [LIMITS.jerk_mps3]
    profile = []
    for target, periods in targets:
        given_.target_velocity = [target]
        for _ in range(periods):
            generator.update(given_, out)
            profile.append(out.new_velocity[0])
            out.pass_to_input(given_)
    return profile


def assert_within_limits(states: NDArray[np.float64]) -> None:
    for column, limits in [
        (3, (LIMITS.speed_mps, LIMITS.acceleration_mps2, LIMITS.jerk_mps3)),
        (5, (LIMITS.turn_rate_rps, LIMITS.turn_acceleration_rps2, LIMITS.turn_jerk_rps3)),
    ]:
        velocity, acceleration = states[:, column], states[:, column + 1]
        assert np.abs(velocity).max() <= limits[0] + 1e-9
        assert np.abs(acceleration).max() <= limits[1] + 1e-9
        assert np.abs(np.diff(acceleration)).max() / STEP_S <= limits[2] + 1e-6
        mean = (acceleration[1:] + acceleration[:-1]) / 2 * STEP_S
        assert np.diff(velocity) == pytest.approx(mean, abs=1e-12)


@settings(deadline=None, max_examples=150)
@given(
    commands=st.lists(
        st.tuples(st.floats(-1, 1), st.floats(-3, 3), st.integers(1, 40)), min_size=1, max_size=15
    )
)
def test_motion_keeps_the_limits_whatever_is_commanded(
    commands: list[tuple[float, float, int]], field: World
) -> None:
    body = body_at(field)
    for linear, angular, steps in commands:
        body.command(Twist2(linear, angular))
        body.advance(body.track.last_step + steps)
    body.halt()
    body.advance(body.track.last_step + 200)
    assert_within_limits(body.track.states)
    assert body.track.now[3:].tolist() == pytest.approx([0.0] * 4, abs=1e-9)


@pytest.mark.parametrize("speed", [0.5, 0.3, 0.02, -0.4])
def test_a_jump_in_speed_is_reached_without_overshoot(speed: float, field: World) -> None:
    states = drive(body_at(field), [Twist2(speed, 0.0)] * 40)
    assert (states[:, 3] / speed).max() <= 1.0 + 1e-9
    assert states[-1, 3] == pytest.approx(speed, abs=1e-9)
    a, j = LIMITS.acceleration_mps2, LIMITS.jerk_mps3
    ramp = abs(speed) / a + a / j if abs(speed) > a * a / j else 2 * math.sqrt(abs(speed) / j)
    reached = int(np.argmax(states[:, 3] / speed > 1 - 1e-6)) * STEP_S
    assert reached <= ramp + 3 * STEP_S


def test_commands_within_the_limits_are_followed_with_half_a_period_of_delay(field: World) -> None:
    profile = shaped([(0.5, 40), (0.0, 40), (0.3, 10), (0.1, 20), (-0.4, 40), (0.0, 40)])
    states = drive(body_at(field), [Twist2(v, 0.0) for v in profile])
    assert np.abs(states[PERIOD::PERIOD, 3] - profile).max() <= 0.026 * LIMITS.acceleration_mps2
    assert_within_limits(states)
    middle = (np.array([0.0, *profile[:-1]]) + profile) / 2
    ideal = np.cumsum(middle) * 0.05
    assert np.abs(states[PERIOD::PERIOD, 0] - ideal).max() <= 0.03 * LIMITS.speed_mps
    assert states[-1, 0] == pytest.approx(ideal[-1], abs=0.001)


def test_a_shaped_brake_ends_at_rest_and_never_rolls_back(field: World) -> None:
    states = drive(body_at(field), [Twist2(v, 0.0) for v in shaped([(0.5, 40), (0.0, 40)])])
    assert states[:, 3].min() >= -1e-9
    assert states[-1, 3:5].tolist() == pytest.approx([0.0, 0.0], abs=1e-9)


def test_constant_twist_drives_an_exact_circle(field: World) -> None:
    body = body_at(field)
    drive(body, [Twist2(0.4, 0.8)] * 60)
    x, y, yaw = body.track.now[:3]
    drive(body, [Twist2(0.4, 0.8)] * 40)
    x1, y1, yaw1 = body.track.now[:3]
    assert yaw1 - yaw == pytest.approx(1.6)
    assert x1 - x == pytest.approx(0.5 * (math.sin(yaw1) - math.sin(yaw)), abs=1e-9)
    assert y1 - y == pytest.approx(-0.5 * (math.cos(yaw1) - math.cos(yaw)), abs=1e-9)


def test_a_halt_brakes_at_the_limits_and_lasts_until_the_next_command(field: World) -> None:
    body = body_at(field)
    drive(body, [Twist2(0.5, 0.0)] * 40)
    before = body.track.now[0]
    body.halt()
    body.halt()
    body.advance(body.track.last_step + 300)
    v, a, j = 0.5, LIMITS.acceleration_mps2, LIMITS.jerk_mps3
    assert body.track.now[0] - before == pytest.approx(v / 2 * (v / a + a / j), abs=0.005)
    assert body.track.now[3] == 0.0
    drive(body, [Twist2(0.2, 0.0)] * 10)
    assert body.track.now[3] > 0.05


def test_half_a_second_after_the_last_command_the_body_brakes(field: World) -> None:
    body = body_at(field)
    drive(body, [Twist2(0.5, 0.0)] * 40)
    body.advance(body.track.last_step + 44)
    assert body.track.now[3] == pytest.approx(0.5)
    body.advance(body.track.last_step + 2)
    assert body.track.now[3] < 0.5
    body.advance(body.track.last_step + 150)
    assert body.track.now[3] == 0.0


def test_the_footprint_is_held_at_the_wall_and_counts_one_touch(hall: World) -> None:
    body = body_at(hall, x=2.0)
    drive(body, [Twist2(0.3, 0.0)] * 200)
    assert body.track.now[0] == pytest.approx(2.75, abs=2e-6)
    assert body.contacts == 1
    drive(body, [Twist2(-0.3, 0.0)] * 30)
    assert body.track.now[0] < 2.7
    drive(body, [Twist2(0.3, 0.0)] * 60)
    assert body.contacts == 2


def test_turning_on_the_spot_at_a_wall_is_no_new_touch(hall: World) -> None:
    body = body_at(hall, x=2.6)
    drive(body, [Twist2(0.3, 0.0)] * 40)
    drive(body, [Twist2(0.0, 1.0)] * 80)
    assert body.contacts == 1
    assert body.track.now[2] > 3.0


@settings(deadline=None, max_examples=40)
@given(
    yaw=st.floats(-math.pi, math.pi),
    turns=st.lists(st.floats(-1.2, 1.2), min_size=1, max_size=8),
)
def test_the_footprint_never_enters_a_wall(yaw: float, turns: list[float], hall: World) -> None:
    body = body_at(hall, x=1.5, yaw=yaw)
    for turn in turns:
        drive(body, [Twist2(0.5, turn)] * 30)
    clearances = [hall.clearance_m(x, y) for x, y in body.track.states[:, :2]]
    assert min(clearances) >= 0.25 - 2e-6


def test_a_long_drive_does_not_depend_on_how_it_is_cut(field: World) -> None:
    whole, parts = body_at(field), body_at(field)
    for body, cut in [(whole, 12_000), (parts, 37)]:
        for until in range(0, 12_000, 40):
            body.command(Twist2(0.3, 0.2 if until % 1000 else -0.2))
            for step in range(until + cut, until + 40, cut):
                body.advance(step)
            body.advance(until + 40)
    assert np.array_equal(whole.track.now, parts.track.now)
    assert whole.track.last_step == 12_000

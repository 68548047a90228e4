import math
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers import Sim2d, Sim2dOptions
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import RobotContext
from explore_bt.types import Measurement, Pose2, Scan2D, Twist2

WORLDS = Path(__file__).parents[2] / "missions" / "worlds"
SHUT, MOVED = "[[2 s, 6 s], [7 s, 9 s]]", "[{at: 3.005, to: [6.2, 2]}, {at: 5, to: [2, 2]}]"
FLAT = f"""\
format: explore-bt-world/1
rooms: [{{name: hall, box: [0, 0, 4, 3]}}, {{name: study, box: [4, 0, 8, 3]}}]
doors: [{{name: exit, at: [4, 1.5], width: 0.9, shut: {SHUT}}}]
furniture: [{{name: chair, box: [6, 0.2, 6.4, 0.6], moved: {MOVED}}}]
"""


def ready(world: Path, start: Pose2 | None = None, **options: object) -> Sim2d:
    driver = Sim2d(Sim2dOptions.model_validate({"world": world, **options}))
    driver.setup(RobotContext(seed=3, start=start))
    return driver


def flat(folder: Path, text: str = FLAT) -> Path:
    path = folder / "flat.yaml"
    path.write_text(text)
    return path


def drive(driver: Sim2d, twist: Twist2, until_s: float) -> list[Measurement]:
    measured: list[Measurement] = []
    for period in range(round(driver.clock.now_s() * 20) + 1, round(until_s * 20) + 1):
        driver.command(twist)
        driver.clock.wait_until(period / 20)
        measured += driver.read()
    return measured


def ahead(measured: list[Measurement]) -> dict[float, float]:
    """By stamp, the range of the beam straight ahead."""
    return {m.stamp_s: float(m.ranges_m[len(m.ranges_m) // 2]) for m in measured if isinstance(m, Scan2D)}


def prints(measured: list[Measurement]) -> list[object]:
    return [m.ranges_m.tobytes() if isinstance(m, Scan2D) else m for m in measured]


def test_the_lidar_sees_a_door_shut_and_open_again(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(3.0, 1.5, 0.0), noise=False, lidar_range=10)
    seen = ahead(drive(driver, Twist2(), 10.0))
    for stamp, metres in seen.items():
        is_shut = 2.0 < stamp <= 6.0 or 7.0 < stamp <= 9.0
        assert metres == pytest.approx(0.98 if is_shut else 4.95), stamp


def test_a_shut_door_stops_the_body_and_an_open_one_lets_it_through(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(2.9, 1.5, 0.0))
    drive(driver, Twist2(), 2.5)
    drive(driver, Twist2(0.5, 0.0), 6.0)
    assert driver.truth().pose().x == pytest.approx(4 - 0.02 - 0.25, abs=1e-5)
    assert driver.truth().contacts() == 1
    assert driver.truth().clearance_m() == pytest.approx(0.25, abs=1e-5)
    drive(driver, Twist2(0.5, 0.0), 9.0)
    assert driver.truth().pose().x > 4.5


def test_a_door_waits_until_the_robot_is_out_of_its_way(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(4.0, 1.5, math.pi), noise=False)
    drive(driver, Twist2(), 3.0)
    assert driver.truth().clearance_m() == pytest.approx(0.45)
    shut_at = None
    while shut_at is None and driver.clock.now_s() < 6.0:
        drive(driver, Twist2(0.2, 0.0), driver.clock.now_s() + 0.05)
        pose = driver.truth().pose()
        if driver.truth().clearance_m() < 3.98 - pose.x + 1e-9:
            shut_at = pose.x
    assert shut_at is not None
    assert shut_at == pytest.approx(4 - 0.02 - 0.26, abs=0.011)
    assert driver.truth().contacts() == 0


def test_a_door_that_should_be_open_by_now_does_not_shut_late(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(4.0, 1.5, math.pi))
    drive(driver, Twist2(), 6.05)
    drive(driver, Twist2(0.5, 0.0), 7.0)
    x = driver.truth().pose().x
    assert driver.truth().clearance_m() == pytest.approx(math.hypot(3.95 - x, 0.45), abs=0.02)


def test_a_thing_that_was_moved_is_seen_and_run_into(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(5.0, 2.0, 0.0), noise=False, lidar_range=10)
    seen = ahead(drive(driver, Twist2(), 6.0))
    for stamp, metres in seen.items():
        assert metres == pytest.approx(1.0 if 3.005 < stamp <= 5.0 else 2.95), stamp
    driver = ready(flat(tmp_path), Pose2(3.0, 2.0, math.pi), noise=False)
    drive(driver, Twist2(), 5.5)
    drive(driver, Twist2(0.5, 0.0), 9.0)
    assert driver.truth().pose().x == pytest.approx(2.45, abs=1e-5)
    assert driver.truth().contacts() == 1


def test_a_thing_is_not_put_onto_the_robot(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(2.0, 2.0, -math.pi / 2), noise=False)
    drive(driver, Twist2(), 6.0)
    assert driver.truth().clearance_m() == pytest.approx(0.95)
    drive(driver, Twist2(0.5, 0.0), 9.0)
    pose = driver.truth().pose()
    assert driver.truth().clearance_m() == pytest.approx(min(1.8 - pose.y, pose.y - 0.05))


@settings(deadline=None, max_examples=10)
@given(cuts=st.lists(st.floats(0.0, 10.0), max_size=12))
def test_changes_do_not_depend_on_how_the_waiting_is_cut_up(
    cuts: list[float], tmp_path_factory: pytest.TempPathFactory
) -> None:
    world = flat(tmp_path_factory.mktemp("cuts"))
    options: dict[str, object] = {"lidar_rate": 7.7, "beams": 90, "walkers": 1}
    whole, parts = (ready(world, Pose2(4.0, 1.5, 0.3), **options) for _ in range(2))
    for driver in (whole, parts):
        driver.command(Twist2(0.3, 0.1))
        driver.clock.wait_until(2.1)
        driver.command(Twist2(0.5, 0.0))
    whole.clock.wait_until(10.0)
    measured: list[Measurement] = []
    for cut in sorted(cuts):
        parts.clock.wait_until(cut)
        measured += parts.read()
    parts.clock.wait_until(10.0)
    measured += list(parts.read())
    assert prints(measured) == prints(list(whole.read()))
    assert parts.truth().pose() == whole.truth().pose()


def test_the_observable_floor_is_that_of_the_drawn_world(tmp_path: Path) -> None:
    driver = ready(flat(tmp_path), Pose2(3.0, 1.5, 0.0))
    drive(driver, Twist2(), 5.0)
    assert driver.truth().observable_floor().free[25, 120]
    plain = ready(flat(tmp_path, FLAT.replace(SHUT, "[]").replace(MOVED, "[]")), Pose2(3.0, 1.5, 0.0))
    late, drawn = driver.truth().observable_floor(), plain.truth().observable_floor()
    assert np.array_equal(late.cells, drawn.cells)


def test_a_minute_in_the_busy_flat() -> None:
    driver = ready(WORLDS / "busy_flat.yaml", walkers=2)
    measured = drive(driver, Twist2(0.2, 0.5), 60.0)
    truth = driver.truth()
    assert len(measured) == 60 * (10 + 100 + 20)
    assert len(truth.people()) == 4
    assert truth.clearance_m() >= 0.25 - 2e-6

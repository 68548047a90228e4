import math

import numpy as np
import pytest
from explore_bt_controllers import Mppi
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import ControlStatus, RobotContext, Surroundings
from explore_bt.testing.controller_contract import (
    KinematicRobot,
    cross_track_error,
    path_through,
    require_limits,
)
from explore_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Estimate,
    MotionLimits,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
)

LIMITS = MotionLimits()
STRAIGHT = path_through([(0.0, 0.0), (6.0, 0.0)])
DT = 0.05


def mppi(**options):
    return Mppi(Mppi.Options(**options))


def ready(seed=0, **options):
    controller = mppi(**options)
    controller.setup(RobotContext(limits=LIMITS, seed=seed))
    return controller


def random_path(rng, pieces=5):
    heading = np.cumsum(rng.uniform(-1.4, 1.4, pieces))
    steps = rng.uniform(0.8, 2.0, pieces)[:, None] * np.column_stack((np.cos(heading), np.sin(heading)))
    return path_through([(0.0, 0.0), *map(tuple, np.cumsum(steps, axis=0))])


def clutter(rng, now_s):
    """Posts, unknown patches and walkers anywhere, on the robot too."""
    cells = np.full((160, 160), FREE, dtype=np.int8)
    for row, col in rng.integers(0, 150, (12, 2)):
        cells[row : row + 6, col : col + 6] = rng.choice([OCCUPIED, UNKNOWN])
    moving = tuple(
        MovingObstacle(k, tuple(rng.uniform(-3, 3, 2)), tuple(rng.uniform(-1.5, 1.5, 2)), 0.25, now_s)
        for k in range(3)
    )
    return Surroundings(
        now_s, rng.uniform(-4.0, 4.0, (100, 2)), OccupancyGrid(cells, 0.05, (-4.0, -4.0)), moving
    )


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 10_000))
def test_limits_hold_among_whatever_appears_around_the_robot(seed):
    rng = np.random.default_rng(seed)
    controller = ready(samples=200)
    robot = KinematicRobot(Pose2(0.0, 0.0, float(rng.uniform(-3.0, 3.0))))
    controller.follow(random_path(rng))
    periods = rng.uniform(0.02, 0.1, 150).tolist()
    for k, dt in enumerate(periods):
        if k % 15 == 0:
            controller.see(clutter(rng, robot.time_s))
        output = controller.step(Estimate(robot.time_s, robot.pose), None, robot.motion, dt)
        robot.drive(output.twist, dt)
    require_limits(robot.motions, LIMITS, periods)


def test_smooth_paths_are_tracked_within_five_centimetres_on_average():
    rng = np.random.default_rng(1)
    controller, worst = ready(), []
    for _ in range(8):
        path = random_path(rng)
        robot = KinematicRobot(Pose2(0.0, 0.0, float(path.poses[0, 2])))
        controller.follow(path)
        assert robot.run(controller, 120.0).status is ControlStatus.ARRIVED
        assert robot.pose.distance_to(path.goal) <= 0.08
        worst.append(cross_track_error(path, robot.poses).max())
    assert np.mean(worst) <= 0.05


def test_the_seed_decides():
    def commands(seed):
        controller, robot = ready(seed), KinematicRobot(Pose2(0.0, 0.1, 0.3))
        controller.follow(STRAIGHT)
        robot.run(controller, 4.0)
        return [motion.twist for motion in robot.motions]

    assert commands(3) == commands(3)
    assert commands(3) != commands(4)


@pytest.mark.parametrize("beside_m", [-0.3, 0.0, 0.1, 0.4])
def test_it_drives_around_a_post_that_no_plan_knew_of(drive, room, disc, beside_m):
    scene = room((-1.0, -2.0), (7.0, 2.0), posts=(disc(3.0, beside_m, 0.15),))
    episode = drive(mppi(), scene, STRAIGHT)
    assert episode.output.status is ControlStatus.ARRIVED, episode.output.reason
    assert episode.least_gap_m > 0.03
    assert episode.braked == 0
    assert cross_track_error(STRAIGHT, episode.robot.poses).max() <= 1.0


def test_a_gap_as_tight_as_the_path_says_is_driven(drive, room):
    scene = room((-1.0, -0.3), (3.0, 0.3))
    poses = path_through([(0.0, 0.0), (2.0, 0.0)]).poses
    episode = drive(mppi(), scene, Path(poses, np.full(len(poses), 0.3)))
    assert episode.output.status is ControlStatus.ARRIVED, episode.output.reason
    assert episode.least_gap_m > 0.03


@pytest.mark.parametrize("seed", range(12))
def test_a_person_who_crosses_is_never_run_into(drive, room, disc, seed):
    rng = np.random.default_rng(seed)
    across, x = rng.uniform(-0.5, 0.5), rng.uniform(1.5, 4.5)
    side, when = rng.choice([-1.0, 1.0]), x / 0.5 + rng.uniform(-1.0, 2.0)
    vx, vy = 1.2 * math.sin(across), 1.2 * side * math.cos(across)
    person = disc(x - when * vx, -when * vy, 0.25, vx, vy)
    episode = drive(mppi(), room((-1.0, -2.5), (7.0, 2.5), people=(person,)), STRAIGHT)
    assert episode.fastest_contact_mps <= 0.05
    assert episode.output.status is ControlStatus.ARRIVED, episode.output.reason


def test_a_person_in_a_corridor_too_narrow_to_pass_is_waited_for_and_named(drive, room, disc):
    scene = room((-1.0, -0.6), (7.0, 0.6), people=(disc(3.0, 0.1, 0.25),))
    episode = drive(mppi(), scene, STRAIGHT)
    assert episode.output.status is ControlStatus.STUCK
    assert "waiting for something that moves, on the path" in episode.output.reason
    assert episode.least_gap_to_people_m > 0.1
    assert episode.robot.motion.twist.linear_mps == pytest.approx(0.0, abs=0.05)


def test_a_post_in_a_corridor_too_narrow_to_pass_is_named(drive, room, disc):
    scene = room((-1.0, -0.6), (7.0, 0.6), posts=(disc(3.0, 0.1, 0.25),))
    episode = drive(mppi(), scene, STRAIGHT)
    assert episode.output.status is ControlStatus.STUCK
    assert "something is on the path" in episode.output.reason
    assert episode.least_gap_m > 0.0


def test_unknown_space_is_not_entered(drive, room, disc):
    scene = room((-1.0, -0.5), (7.0, 0.5), posts=(disc(3.0, 0.0, 0.3),))
    episode = drive(mppi(), scene, STRAIGHT)
    assert all(abs(pose.y) < 0.25 for pose in episode.robot.poses)

import os
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.replay import CarmenLog
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.errors import LogError
from explore_bt.evaluation import Relation, read_relations, relation_errors
from explore_bt.types import Pose2, Trajectory, WheelOdometry

DATA = os.environ.get("EXPLORE_BT_DATA", "")
STAMPS = np.array([1.0, 2.0, 3.0])
POSES = st.builds(Pose2, *[st.floats(-50.0, 50.0)] * 2, st.floats(-3.0, 3.0))


def matrix(pose: Pose2) -> np.ndarray:
    cos, sin = np.cos(pose.yaw_rad), np.sin(pose.yaw_rad)
    return np.array([[cos, -sin, pose.x], [sin, cos, pose.y], [0.0, 0.0, 1.0]])


def trajectory(*poses: Pose2) -> Trajectory:
    return Trajectory(STAMPS[: len(poses)], np.array([pose.as_array() for pose in poses]))


@given(POSES, POSES, POSES)
def test_the_error_is_that_of_homogeneous_matrices(begin, end, true):
    errors = relation_errors(trajectory(begin, end), [Relation(1.0, 2.0, true)])
    off = np.linalg.inv(matrix(true)) @ np.linalg.inv(matrix(begin)) @ matrix(end)
    assert errors.translations_m == pytest.approx([np.hypot(off[0, 2], off[1, 2])], abs=1e-9)
    assert errors.rotations_rad == pytest.approx([abs(np.arctan2(off[1, 0], off[0, 0]))], abs=1e-7)


@given(st.lists(POSES, min_size=3, max_size=3), POSES)
def test_a_true_trajectory_has_no_error_wherever_its_map_lies(way, moved):
    relations = [Relation(i + 1.0, i + 2.0, a.between(b)) for i, (a, b) in enumerate(pairwise(way))]
    figures = relation_errors(trajectory(*(moved.compose(pose) for pose in way)), relations).as_dict()
    assert figures.pop("count") == 2
    assert list(figures.values()) == pytest.approx([0.0] * 5, abs=1e-6)


def test_the_figures_are_mean_and_deviation():
    way = trajectory(Pose2(0, 0, 0), Pose2(1, 0, 0), Pose2(4, 0, 0.5))
    still = [
        Relation(1.0, 2.0, Pose2(0, 0, 0)),
        Relation(2.0, 3.0, Pose2(0, 0, 0)),
        Relation(3.0, 9.0, Pose2(0, 0, 0)),
    ]
    assert relation_errors(way, still).as_dict() == pytest.approx(
        {
            "count": 2,
            "missing": 1,
            "translation_mean_m": 2.0,
            "translation_sd_m": 1.0,
            "rotation_mean_deg": np.degrees(0.25),
            "rotation_sd_deg": np.degrees(0.25),
        }
    )


def test_relations_of_another_log_are_refused():
    with pytest.raises(LogError, match="none of the 1 relations has both its stamps"):
        relation_errors(trajectory(Pose2(0, 0, 0)), [Relation(7.0, 8.0, Pose2(0, 0, 0))])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no relation; expected lines of t1 t2 x y z roll pitch yaw"),
        ("# only words\n", "holds no relation"),
        ("1 2 0 0 0 0 0 0\n1 2 0 0\n", ":2: found 4 words; expected 8"),
        ("\n1 2 0 0 x 0 0 0\n", ':2: z is "x"; expected a finite number'),
        ("1 2 0 0 0 0 0 nan\n", ':1: yaw is "nan"'),
    ],
)
def test_what_is_wrong_with_a_file_is_told_with_its_line(tmp_path, text, message):
    path = tmp_path / "some.relations"
    path.write_text(text)
    with pytest.raises(LogError) as caught:
        read_relations(path)
    assert message in str(caught.value)


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(LogError, match=r"none\.relations: cannot be read \(no such file"):
        read_relations(tmp_path / "none.relations")


@given(st.binary(max_size=200))
def test_any_bytes_are_relations_or_a_clear_fault(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("fuzz") / "some.relations"
    path.write_bytes(content)
    with suppress(LogError):
        assert read_relations(path)


@pytest.mark.skipif(not DATA, reason="EXPLORE_BT_DATA names no folder of recorded logs")
@pytest.mark.parametrize(("log", "metres", "degrees"), [("intel", 7.370, 39.2), ("fr079", 6.504, 30.3)])
def test_raw_odometry_has_the_published_error(log, metres, degrees):
    folder = Path(DATA) / "carmen"
    odometry = [one for one in CarmenLog(folder / f"{log}.clf.bz2") if isinstance(one, WheelOdometry)]
    way = Trajectory(
        np.array([one.stamp_s for one in odometry]),
        np.array([one.T_odom_base.as_array() for one in odometry]),
    )
    figures = relation_errors(way, read_relations(folder / f"{log}.relations")).as_dict()
    assert figures["missing"] == 0
    assert figures["translation_mean_m"] == pytest.approx(metres, abs=5e-4)
    assert figures["rotation_mean_deg"] == pytest.approx(degrees, abs=0.05)

"""Whom a robot believes where it is: decisions over a SLAM that a test speaks for."""

import numpy as np
import pytest

from explore_bt.fleet import SAME, Frames, GraphTeller, Presence
from explore_bt.interfaces import GraphShare
from explore_bt.types import STRETCH_KEYFRAMES, MapFit, Pose2, SharedKeyframe, SharedStretch, Twist2

NOWHERE = np.empty((0, 2))
MOVED = MapFit.rigid(Pose2(2.0, 0.0, 1.05))


class Finder(GraphShare):
    """Finds what the test puts into ``found``."""

    def __init__(self, can_find: bool = True) -> None:
        self.can_find = can_find
        self.found: dict[str, MapFit] = {}
        self.expected: dict[str, Pose2] = {}
        self.doubted: set[str] = set()

    def expect(self, mate: str, T_ours_theirs: Pose2) -> None:
        self.expected[mate] = T_ours_theirs

    def fit(self, mate: str) -> MapFit | None:
        return self.found.get(mate)

    def doubts(self, mate: str) -> bool:
        return mate in self.doubted

    def refuse(self, mate: str) -> None:
        self.found.pop(mate, None)

    def why_not(self, mate: str) -> str:
        return "no place that both know was found"


class Robot:
    def __init__(self, knows_start: bool = True, can_find: bool = True) -> None:
        self.share, self.told = Finder(can_find), []
        self.frames = Frames(knows_start, self.share, lambda *event: self.told.append(event))

    def hear(self, knows_start: bool = True, shares_graph: bool = True) -> None:
        self.frames.hear(
            "bob",
            Presence(
                1.0,
                1.05,
                Pose2.identity(),
                Twist2(),
                0.25,
                0.5,
                NOWHERE,
                NOWHERE,
                knows_start=knows_start,
                shares_graph=shares_graph,
            ),
        )
        self.frames.look()
        self.frames.tell_news({"bob"})


def test_nobody_is_believed_who_has_not_been_heard() -> None:
    ada = Robot()
    assert ada.frames.way("bob") is None
    assert ada.frames.chart("bob") is None


def test_given_starts_are_driven_by_at_once_and_merged_once_closures_agree() -> None:
    ada = Robot()
    ada.hear()
    assert ada.frames.way("bob") is SAME
    assert ada.frames.chart("bob") is None
    assert ada.share.expected == {"bob": Pose2.identity()}
    assert "its start is to be checked" in ada.frames.why_not()["bob"]
    ada.share.found["bob"] = MapFit.rigid(Pose2(0.01, 0.0, 0.0))
    ada.hear()
    assert ada.frames.chart("bob") is ada.share.found["bob"]
    assert ada.frames.way("bob") is ada.share.found["bob"]
    assert ada.told == [("info", "team", "robot bob is merged: closures agree with the start that was given")]


def test_given_starts_alone_have_to_do_where_no_slam_can_check_them() -> None:
    for can_find, shares_graph in ((False, True), (True, False)):
        ada = Robot(can_find=can_find)
        ada.hear(shares_graph=shares_graph)
        assert ada.frames.chart("bob") is SAME


def test_a_robot_whose_start_nobody_knows_is_a_stranger_until_closures_tell() -> None:
    for ours, theirs in ((False, True), (True, False), (False, False)):
        ada = Robot(knows_start=ours)
        ada.hear(knows_start=theirs)
        assert ada.frames.way("bob") is None
        assert ada.frames.why_not() == {
            "bob": "nobody has said where it began; no place that both know was found"
        }
        assert not ada.share.expected
        ada.share.found["bob"] = MOVED
        ada.hear(knows_start=theirs)
        assert ada.frames.way("bob") is ada.frames.chart("bob") is MOVED
        assert ada.frames.why_not() == {}
        assert ada.told[-1][2] == "robot bob is merged: closures have told where it began"


def test_a_start_that_was_given_wrong_is_told_of_with_how_wrong_it_is() -> None:
    ada = Robot()
    ada.hear()
    ada.share.found["bob"] = MOVED
    ada.hear()
    assert ada.told[-1][2].endswith("closures put the start that was given 2.0 m and 60 deg off")


def test_a_start_that_first_closures_speak_against_is_not_driven_by_any_more() -> None:
    ada = Robot()
    ada.hear()
    ada.share.doubted.add("bob")
    ada.hear()
    assert ada.frames.way("bob") is None
    assert ada.frames.why_not()["bob"].startswith("its start seems to be wrong")


def test_what_is_refused_is_neither_driven_by_nor_merged_until_closures_say_something_else() -> None:
    for can_find in (True, False):
        ada = Robot(can_find=can_find)
        ada.hear()
        ada.frames.refuse("bob", "2.7 m of wall of one map are free floor in the other")
        ada.hear()
        assert ada.frames.way("bob") is None
        assert ada.frames.chart("bob") is None
        assert ada.told[-1][:2] == ("warning", "team")
        assert "not merged: 2.7 m of wall" in ada.told[-1][2]
        assert ada.frames.why_not() == {"bob": "2.7 m of wall of one map are free floor in the other"}


def test_what_a_mate_has_found_out_is_where_to_look_first() -> None:
    ada = Robot(knows_start=False)
    ada.hear()
    ada.frames.hint("bob", Pose2(1.0, 2.0, 3.0))
    assert ada.share.expected == {"bob": Pose2(1.0, 2.0, 3.0)}
    assert ada.frames.chart("bob") is None, "a hint is no proof"
    ada.share.found["bob"] = MOVED
    ada.hear()
    assert ada.frames.found().T_ours_theirs["bob"].yaw_rad == pytest.approx(1.05)


class Graph(GraphShare):
    def __init__(self) -> None:
        self.poses = np.zeros((0, 3))

    def keyframe_count(self) -> int:
        return len(self.poses)

    def keyframe(self, number: int) -> SharedKeyframe:
        return SharedKeyframe(number, float(number), 0.5 * number, np.zeros((1, 2)))

    def stretch(self, number: int) -> SharedStretch:
        first = number * STRETCH_KEYFRAMES
        return SharedStretch(number, self.poses[first : first + STRETCH_KEYFRAMES], ())


def test_of_a_graph_only_what_is_new_or_has_moved_is_told() -> None:
    graph = Graph()
    teller = GraphTeller(graph)
    assert list(teller.fresh()) == []
    graph.poses = np.zeros((20, 3))
    told = list(teller.fresh())
    assert [each.number for each in told if isinstance(each, SharedKeyframe)] == list(range(20))
    assert [each.number for each in told if isinstance(each, SharedStretch)] == [0, 1]
    assert list(teller.fresh()) == []
    graph.poses = np.vstack((graph.poses, np.zeros((1, 3))))
    graph.poses[2, 0] = 0.005
    assert [each.number for each in teller.fresh()] == [20, 1], "half a centimetre is not worth a word"
    graph.poses = graph.poses + np.array([0.0, 0.02, 0.0])
    assert [each.number for each in teller.fresh()] == [0, 1]

"""Two robots' pose graphs as one: closures between them, and what is not believed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.guests import guest_key
from explore_bt_slam.kiss_share import KissShare
from explore_bt_slam.pose_graph import Edge

from explore_bt.testing.slam_room import Room
from explore_bt.types import STRETCH_KEYFRAMES, MapFit, Pose2, wrap_angle
from tests.slam.driven_ways import STEADY, along, equal_rooms, rectangle, sweep_at

LOOKS = 16
"""Control periods between two keyframes, about."""


def flat() -> Room:
    """Three rooms on a hall, each with furniture of its own."""
    segments = rectangle(0.0, 0.0, 12.0, 8.0)
    segments += [[0.0, 3.0, 2.0, 3.0], [3.0, 3.0, 6.5, 3.0], [7.5, 3.0, 12.0, 3.0]]
    segments += [[0.0, 4.6, 4.0, 4.6], [5.0, 4.6, 9.0, 4.6], [10.0, 4.6, 12.0, 4.6]]
    segments += [[5.0, 0.0, 5.0, 3.0], [7.0, 4.6, 7.0, 8.0]]
    for box in ((0.4, 0.3, 1.5, 1.0), (4.0, 2.0, 4.8, 2.7), (8.0, 0.2, 10.2, 0.9), (11.0, 1.8, 11.8, 2.6)):
        segments += rectangle(*box)
    for box in ((0.3, 6.9, 2.4, 7.8), (5.6, 5.2, 6.4, 5.7), (8.3, 6.7, 9.1, 7.6), (11.2, 5.0, 11.8, 6.8)):
        segments += rectangle(*box)
    return Room(np.array(segments), np.zeros((0, 3)))


ADA_WAY = [(1.0, 3.8), (2.5, 3.8), (2.5, 1.5), (2.5, 3.8), (4.5, 3.8), (4.5, 6.0), (2.0, 6.0), (4.5, 6.0)]
ADA_WAY += [(4.5, 3.8), (11.0, 3.8), (9.5, 3.8), (9.5, 6.0)]
BOB_WAY = [(11.0, 3.8), (9.5, 3.8), (9.5, 6.0), (9.5, 3.8), (7.0, 3.8), (7.0, 1.5), (10.0, 1.5), (7.0, 1.5)]
BOB_WAY += [(7.0, 3.8), (1.0, 3.8), (2.5, 3.8), (2.5, 1.5)]


class Driven:
    """A robot on its way; its map begins at ``begin``, wherever it really stands; None: where it stands."""

    def __init__(
        self,
        room: Room,
        corners: Sequence[tuple[float, float]],
        begin: Pose2 | None,
        seed: int,
        turn_rad: float = 0.0,
    ) -> None:
        self.way = list(along(corners))
        self._room, self._seed = room, seed
        self.is_hinted = False
        self._rng = np.random.default_rng(seed)
        self._bias = np.array([0.0, 0.0, turn_rad])
        self.back = BackEnd(loop_closures=True)
        self.share = KissShare(lambda: self.back)
        begin = begin or self.way[0]
        self.back.begin(sweep_at(room, self.way[0], 1000 * seed), begin)
        self.T_map_world = begin.compose(self.way[0].inverse())

    def drive(self) -> None:
        """On to the next keyframe, a little off."""
        number = len(self.back.keyframes)
        if number >= len(self.way):
            return
        error = Pose2(*(self._rng.normal(0.0, STEADY) + self._bias).tolist())
        step = self.way[number - 1].between(self.way[number]).compose(error)
        sweep = sweep_at(self._room, self.way[number], 1000 * self._seed + number)
        covariance = np.diag(STEADY + self._bias) ** 2
        self.back.extend(sweep, number - 1, step, covariance)

    def hear(self, name: str, other: Driven, first: int) -> None:
        """All that the other has to tell, from a keyframe on."""
        for number in range(first, other.share.keyframe_count()):
            self.share.take(name, other.share.keyframe(number))
        for number in range(math.ceil(other.share.keyframe_count() / STRETCH_KEYFRAMES)):
            self.share.take(name, other.share.stretch(number))

    def error_m(self) -> float:
        """Of its keyframes in its own map, at worst."""
        true = [self.T_map_world.compose(pose) for pose in self.way[: len(self.back.keyframes)]]
        return max(self.back.pose(k).distance_to(pose) for k, pose in enumerate(true))


def drive_both(ada: Driven, bob: Driven, steps: int | None = None) -> list[bool]:
    """Together, each hearing the other; whether ada has a fit, after each keyframe."""
    fits = []
    for _ in range(steps or max(len(ada.way), len(bob.way))):
        heard = (bob.share.keyframe_count(), ada.share.keyframe_count())
        ada.drive()
        bob.drive()
        ada.hear("bob", bob, heard[0] - 1)
        bob.hear("ada", ada, heard[1] - 1)
        for _ in range(LOOKS):
            ada.share.look()
            bob.share.look()
        hint(ada, "bob", bob, "ada")
        hint(bob, "ada", ada, "bob")
        fits.append(ada.share.fit("bob") is not None)
    return fits


def hint(one: Driven, name: str, other: Driven, other_name: str) -> None:
    """Who has found out how the maps lie says so once, as robots of a fleet do."""
    fit = other.share.fit(other_name)
    if fit is not None and not one.is_hinted and one.share.fit(name) is None:
        one.is_hinted = True
        one.share.expect(name, fit.at_theirs(*fit.theirs[-1, :2].tolist()).inverse())


def off(fit: MapFit, ours: Driven, theirs: Driven) -> tuple[float, float]:
    """How wrong a fit is about the other's keyframes: metres and radians, at worst."""
    true = ours.T_map_world.compose(theirs.T_map_world.inverse())
    worst_m, worst_rad = 0.0, 0.0
    for x, y, yaw in fit.theirs.tolist():
        here, there = fit.at_theirs(x, y).compose(Pose2(x, y, yaw)), true.compose(Pose2(x, y, yaw))
        worst_m = max(worst_m, here.distance_to(there))
        worst_rad = max(worst_rad, abs(wrap_angle(here.yaw_rad - there.yaw_rad)))
    return worst_m, worst_rad


def check_fits(ada: Driven, bob: Driven) -> None:
    """Both know how the other's map lies, about every keyframe of it."""
    for one, name, other in ((ada, "bob", bob), (bob, "ada", ada)):
        fit = one.share.fit(name)
        assert fit is not None, one.share.why_not(name)
        off_m, off_rad = off(fit, one, other)
        assert off_m < 0.2, "what each knows of its own keyframes counts too"
        assert off_rad < 0.03


def test_robots_that_know_nothing_of_each_others_start_find_out_how_their_maps_lie() -> None:
    """The flat looks much the same from both ends of its hall: for 24 keyframes all closures are false."""
    ada = Driven(flat(), ADA_WAY, Pose2.identity(), 1)
    bob = Driven(flat(), BOB_WAY, Pose2.identity(), 2)
    for step in range(len(ada.way)):
        drive_both(ada, bob, 1)
        fit = ada.share.fit("bob")
        assert fit is None or off(fit, ada, bob)[0] < 0.3, f"believed a false fit after {step} keyframes"
    check_fits(ada, bob)


def test_a_start_that_was_given_right_is_believed_after_a_few_keyframes() -> None:
    ada = Driven(flat(), ADA_WAY, None, 1)
    bob = Driven(flat(), ADA_WAY[1:], None, 2)
    ada.share.expect("bob", Pose2.identity())
    bob.share.expect("ada", Pose2.identity())
    fits = drive_both(ada, bob, 12)
    assert not fits[0]
    check_fits(ada, bob)


def test_a_start_that_was_given_wrong_by_two_metres_and_sixty_degrees_is_corrected() -> None:
    ada = Driven(flat(), ADA_WAY, None, 1)
    bob = Driven(flat(), ADA_WAY[1:], Pose2(2.5 + 1.6, 3.3 + 1.2, -math.pi / 2 + math.pi / 3), 2)
    ada.share.expect("bob", Pose2.identity())
    bob.share.expect("ada", Pose2.identity())
    drive_both(ada, bob, 70)
    check_fits(ada, bob)


def test_robots_in_rooms_that_look_alike_are_right_about_each_other_or_know_nothing() -> None:
    room = equal_rooms(5)
    ways = [
        [(4.0 * first - 1.0, 0.8)]
        + [xy for k in rooms for xy in [(4.0 * k + 1.8, 0.8), (4.0 * k + 1.8, 3.0), (4.0 * k + 1.8, 0.8)]]
        for first, rooms in ((0, (0, 1, 2)), (3, (3, 2, 1)))
    ]
    ada, bob = Driven(room, ways[0], Pose2.identity(), 1), Driven(room, ways[1], Pose2.identity(), 2)
    drive_both(ada, bob)
    for one, name, other in ((ada, "bob", bob), (bob, "ada", ada)):
        fit = one.share.fit(name)
        assert fit is None or off(fit, one, other)[0] < 0.15


def test_a_false_closure_with_a_mate_moves_nothing() -> None:
    ada = Driven(flat(), ADA_WAY, None, 1)
    bob = Driven(flat(), ADA_WAY[1:], None, 2)
    ada.share.expect("bob", Pose2.identity())
    drive_both(ada, bob, 14)
    before = ada.back.poses.copy()
    lie = Pose2(0.6, -0.4, 0.2)
    for number in (6, 8, 10):
        key = guest_key(0, number)
        true = ada.back.pose(number).between(ada.back.pose(key))
        false = Edge(number, key, true.compose(lie), np.diag([0.01, 0.01, 0.005]) ** 2, is_closure=True)
        assert not ada.back.graph.tie([false]), "the graph knows better"
        ada.back.graph.receive({}, [false])
        assert np.hypot(*(ada.back.poses - before)[:, :2].T).max() < 0.02, "even if it is let in"


def test_drift_is_taken_out_by_what_the_mate_has_measured() -> None:
    """Ada's way leads out and back on itself only at its end; bob drives it the other way, straight."""
    alone = Driven(flat(), ADA_WAY, None, 1, turn_rad=0.012)
    ada = Driven(flat(), ADA_WAY, None, 1, turn_rad=0.012)
    bob = Driven(flat(), [ADA_WAY[1], *ADA_WAY[4:], (1.0, 3.8)], None, 2)
    ada.share.expect("bob", Pose2.identity())
    bob.share.expect("ada", Pose2.identity())
    for _ in range(len(alone.way)):
        alone.drive()
    drive_both(ada, bob)
    assert ada.error_m() < 0.6 * alone.error_m()
    assert bob.error_m() < 0.12, "and bob is not led astray"


def test_a_fit_that_is_refused_is_not_found_again() -> None:
    ada = Driven(flat(), ADA_WAY, None, 1)
    bob = Driven(flat(), ADA_WAY[1:], None, 2)
    ada.share.expect("bob", Pose2.identity())
    drive_both(ada, bob, 12)
    assert ada.share.fit("bob") is not None
    count = len(ada.back.poses)
    ada.share.refuse("bob")
    assert ada.share.fit("bob") is None
    assert len(ada.back.poses) == count
    drive_both(ada, bob, 14)
    assert ada.share.fit("bob") is None


def test_a_mate_that_has_begun_anew_is_a_stranger() -> None:
    ada = Driven(flat(), ADA_WAY, None, 1)
    bob = Driven(flat(), ADA_WAY[1:], None, 2)
    ada.share.expect("bob", Pose2.identity())
    drive_both(ada, bob, 12)
    again = Driven(flat(), BOB_WAY, None, 3)
    again.drive()
    ada.hear("bob", again, 0)
    assert ada.share.fit("bob") is None

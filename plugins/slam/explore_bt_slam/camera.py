"""The camera's newest image, until a keyframe wants it."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt.types import Pose2, RgbdFrame
from explore_bt_slam.sight import Sight, SightMaker
from explore_bt_slam.sight_match import FEWEST, SightMatch, match_sights

__all__ = ["Camera", "Look"]

_STALE_S = 0.5


@dataclass(frozen=True, slots=True)
class Look:
    """What an image says without being kept.

    Attributes:
        match: ``relative`` is ``T_keyframe_now``; None where image and keyframe have too little in common.
        is_rich: whether the image has features enough to be found again.
    """

    match: SightMatch | None = None
    is_rich: bool = False


class Camera:
    """Holds one image and where it was taken; only keyframes have it looked at."""

    def __init__(self) -> None:
        self._maker = SightMaker()
        self._newest: tuple[RgbdFrame, Pose2] | None = None
        self._sights: tuple[Sight | None, Sight | None] = (None, None)

    def take(self, frame: RgbdFrame, T_keyframe_base: Pose2) -> None:
        """An image, taken at ``T_keyframe_base`` from the present keyframe."""
        self._newest = (frame, T_keyframe_base)

    def first(self, frame: RgbdFrame, T_keyframe_base: Pose2) -> Sight:
        """The features of the first image of all: its keyframe was made before it came."""
        sight = self._maker.sight(frame, T_keyframe_base)
        self._sights = (None, sight)
        return sight

    def forget(self) -> None:
        """The next keyframe does not follow the last one."""
        self._newest, self._sights = None, (None, None)

    def step(self) -> SightMatch | None:
        """How the last two keyframes lie to each other by what both see; None if that says nothing."""
        before, last = self._sights
        return None if before is None or last is None else match_sights(before, last)

    def look(self, T_keyframe_now: Pose2) -> Look:
        """How the newest image lies to the last keyframe by what both see, without one being made.

        Args:
            T_keyframe_now: where the robot believes to be, seen from the keyframe: it moves the image's own
                place to that of the robot.
        """
        last = self._sights[1]
        if self._newest is None:
            return Look()
        frame, T_keyframe_base = self._newest
        now = self._maker.sight(frame, T_keyframe_now.between(T_keyframe_base))
        return Look(None if last is None else match_sights(last, now), now.points.shape[0] >= FEWEST)

    def sight(self, stamp_s: float, T_keyframe_new: Pose2) -> Sight | None:
        """What the keyframe made at ``stamp_s``, at ``T_keyframe_new`` from the last one, looks like.

        None without an image of the half second before it.
        """
        newest, self._newest = self._newest, None
        sight = None
        if newest is not None and 0.0 <= stamp_s - newest[0].stamp_s <= _STALE_S:
            frame, T_keyframe_base = newest
            sight = self._maker.sight(frame, T_keyframe_new.between(T_keyframe_base))
        self._sights = (self._sights[1], sight)
        return sight

"""The camera's newest image, until a keyframe wants it."""

from __future__ import annotations

from explore_bt.types import Pose2, RgbdFrame
from explore_bt_slam.sight import Sight, SightMaker

__all__ = ["Camera"]

_STALE_S = 0.5


class Camera:
    """Holds one image and where it was taken; only keyframes have it looked at."""

    def __init__(self) -> None:
        self._maker = SightMaker()
        self._newest: tuple[RgbdFrame, Pose2] | None = None

    def take(self, frame: RgbdFrame, T_keyframe_base: Pose2) -> None:
        """An image, taken at ``T_keyframe_base`` from the present keyframe."""
        self._newest = (frame, T_keyframe_base)

    def first(self, frame: RgbdFrame, T_keyframe_base: Pose2) -> Sight:
        """The features of the first image of all: its keyframe was made before it came."""
        return self._maker.sight(frame, T_keyframe_base)

    def sight(self, stamp_s: float, T_keyframe_new: Pose2) -> Sight | None:
        """What the keyframe made at ``stamp_s``, at ``T_keyframe_new`` from the last one, looks like.

        None without an image of the half second before it.
        """
        newest, self._newest = self._newest, None
        if newest is None or not 0.0 <= stamp_s - newest[0].stamp_s <= _STALE_S:
            return None
        frame, T_keyframe_base = newest
        return self._maker.sight(frame, T_keyframe_new.between(T_keyframe_base))

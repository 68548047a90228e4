"""From posed sweeps to a grid: draws what is new, and draws anew when the graph has moved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import GridWindow, OccupancyGrid, Pose2, wrap_angle
from explore_bt_slam.canvas import Canvas
from explore_bt_slam.sweep import Sweep

__all__ = ["KeptSweep", "Mapper", "apart", "has_moved"]

_SPACING_M = 0.1
_SPACING_RAD = 0.1
_REFRESH_S = 0.5
_MOVED_M = 0.01
_MOVED_RAD = 0.1 * np.pi / 180.0


@dataclass(frozen=True, slots=True, eq=False)
class KeptSweep:
    """A sweep that is drawn again when its keyframe moves; ``relative`` is ``T_keyframe_base``."""

    keyframe: int
    relative: Pose2
    sweep: Sweep


class Mapper:
    """Keeps the sweeps that made the map, each tied to a keyframe.

    A sweep is drawn after 0.1 m, 0.1 rad or 0.5 s, so that standing still neither hardens the map nor
    costs anything; it is kept after 0.1 m or 0.1 rad, so that memory grows with the way and not with time.
    """

    def __init__(self, resolution_m: float, body_radius_m: float) -> None:
        self._canvas = Canvas(resolution_m, body_radius_m)
        self._kept: list[KeptSweep] = []
        self._drawn_at: tuple[Pose2, float] | None = None
        self._kept_at: Pose2 | None = None
        self._keyframes = np.zeros((0, 3))
        self._moved_to: NDArray[np.float64] | None = None

    @property
    def revision(self) -> int:
        """See ``Canvas.revision``; a redraw that is due counts as done."""
        return self._canvas.revision + (self._moved_to is not None)

    @property
    def kept(self) -> list[KeptSweep]:
        """All that a redraw draws."""
        return self._kept

    def begin(self, keyframe_pose: Pose2, relative: Pose2) -> None:
        """The robot stands here: the floor under its body is free, before any scan says so."""
        stand = Sweep(
            -np.inf, np.zeros((0, 2), np.float32), np.zeros((0, 2), np.float32), np.zeros(0, np.bool_)
        )
        self._kept = [KeptSweep(0, relative, stand)]
        self._canvas.draw(stand, keyframe_pose.compose(relative))

    def see(self, sweep: Sweep, keyframe: int, keyframe_pose: Pose2, relative: Pose2) -> None:
        """Draw a sweep if it is worth it."""
        pose = keyframe_pose.compose(relative)
        if self._drawn_at is not None:
            last, stamp_s = self._drawn_at
            if not apart(last, pose) and sweep.stamp_s - stamp_s < _REFRESH_S:
                return
        if self._moved_to is None:
            self._canvas.draw(sweep, pose)
        self._drawn_at = (pose, sweep.stamp_s)
        if self._kept_at is None or apart(self._kept_at, pose):
            self._kept.append(KeptSweep(keyframe, relative, sweep))
            self._kept_at = pose

    def forget_near(self, position: tuple[float, float], radius_m: float) -> bool:
        """See ``Slam.forget_near``; a redraw brings back what the kept sweeps show."""
        self._catch_up()
        self._canvas.forget_near(position, radius_m)
        return True

    def follow(self, keyframes: NDArray[np.float64]) -> None:
        """The graph's poses, (N, 3): a redraw is due if one has moved by more than 1 cm or 0.1° since drawn.

        It is done when somebody looks: closures come in rows, and most of their maps nobody ever sees.
        """
        known = self._keyframes.shape[0]
        if self._moved_to is not None or (known and has_moved(self._keyframes, keyframes[:known])):
            self._moved_to = keyframes.copy()
        else:
            self._keyframes = np.vstack((self._keyframes, keyframes[known:]))

    def redraw(self, keyframes: NDArray[np.float64]) -> None:
        """Draw every kept sweep from where its keyframe is now."""
        poses = [Pose2(float(x), float(y), float(yaw)) for x, y, yaw in keyframes]
        self._canvas.redraw(
            [(kept.sweep, poses[kept.keyframe].compose(kept.relative)) for kept in self._kept]
        )
        self._keyframes = keyframes.copy()
        self._moved_to = None
        self._drawn_at = None

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The grid's state; the kept sweeps are apart."""
        self._catch_up()
        return self._canvas.arrays()

    def restore(
        self, arrays: Mapping[str, NDArray[Any]], kept: list[KeptSweep], keyframes: NDArray[np.float64]
    ) -> None:
        """The map of a saved state."""
        self._canvas.restore(arrays)
        self._kept = list(kept)
        self._keyframes = keyframes.copy()
        self._moved_to = None

    def grid(self) -> OccupancyGrid:
        """The map as it stands."""
        self._catch_up()
        return self._canvas.snapshot()

    def changed_since(self, revision: int) -> GridWindow | None:
        """See ``Slam.changed_since``."""
        self._catch_up()
        return self._canvas.changed_since(revision)

    def _catch_up(self) -> None:
        if self._moved_to is not None:
            self.redraw(self._moved_to)


def apart(a: Pose2, b: Pose2) -> bool:
    """Whether a sweep from ``b`` shows enough that one from ``a`` did not."""
    return a.distance_to(b) >= _SPACING_M or abs(wrap_angle(b.yaw_rad - a.yaw_rad)) >= _SPACING_RAD


def has_moved(before: NDArray[np.float64], after: NDArray[np.float64]) -> bool:
    """Whether any of (N, 3) poses is off by more than 1 cm or 0.1°."""
    off = after - before
    yaw = (off[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    return bool(np.hypot(off[:, 0], off[:, 1]).max() > _MOVED_M or np.abs(yaw).max() > _MOVED_RAD)

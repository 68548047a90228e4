"""Controller ``pursuit``: curvature ahead, Samson's feedback, limits kept period by period."""

from __future__ import annotations

from typing import ClassVar

from explore_bt.interfaces import API_VERSION, PluginOptions
from explore_bt.types import Path
from explore_bt_controllers.curvature_law import CurvatureLaw
from explore_bt_controllers.driving_law import DrivingLaw
from explore_bt_controllers.options import PursuitOptions
from explore_bt_controllers.path_following import PathFollowing

__all__ = ["Pursuit"]


class Pursuit(PathFollowing):
    """Follows a path by its curvature and by feedback on the offset from it.

    Speed is the greatest from which a jerk-limited brake keeps every limit that the path's curvature sets
    ahead, its end included. Bends too sharp to drive are turned in place.
    """

    name: ClassVar[str] = "pursuit"
    api_version: ClassVar[int] = API_VERSION
    Options: ClassVar[type[PluginOptions]] = PursuitOptions

    def __init__(self, options: PursuitOptions) -> None:
        super().__init__(options)
        self._options = options

    def _law_for(self, path: Path) -> DrivingLaw:
        return CurvatureLaw(path, self._options, self._footprint_m)

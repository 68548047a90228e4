"""What a leaf saw when it decided, as markers for RViz."""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from explore_bt.types import Drawing, Path, Verdict

__all__ = ["marks_of"]

_COLOURS = {
    Verdict.TAKEN: (0.06, 0.62, 0.46),
    Verdict.REJECTED: (0.84, 0.15, 0.24),
    Verdict.OPEN: (0.54, 0.58, 0.63),
}
_ARC = 8


def marks_of(drawing: Drawing, path: Path | None, frame: str, stamp: Any) -> Any:
    """A ``MarkerArray``: the goal, frontiers, free sectors, views; what was shown before is deleted first.

    Args:
        drawing: of the last decision.
        path: being driven; its end is the waypoint.
        frame: of the map.
        stamp: of the message.
    """
    marks = _Marks(frame, stamp)
    if path is not None:
        goal = path.goal
        marks.arrow("waypoint", goal.x, goal.y, goal.yaw_rad, Verdict.TAKEN, "waypoint")
    for frontier in drawing.frontiers or ():
        marks.disc("frontiers", frontier.x, frontier.y, 0.15, frontier.state, frontier.reason)
    for view in drawing.views or ():
        marks.arrow("views", view.x, view.y, view.yaw_rad, view.state, view.reason)
    for sector in drawing.sectors or ():
        angles = [
            sector.from_rad + (sector.to_rad - sector.from_rad) * step / _ARC for step in range(_ARC + 1)
        ]
        rim = [
            (sector.x + sector.range_m * math.cos(angle), sector.y + sector.range_m * math.sin(angle))
            for angle in angles
        ]
        marks.line("sectors", [(sector.x, sector.y), *rim, (sector.x, sector.y)], sector.state)
    return marks.array


class _Marks:
    def __init__(self, frame: str, stamp: Any) -> None:
        self._frame, self._stamp = frame, stamp
        self.array: Any = MarkerArray(markers=[Marker(action=Marker.DELETEALL)])
        self.array.markers[0].header.frame_id = frame

    def disc(self, layer: str, x: float, y: float, radius_m: float, state: Verdict, words: str) -> None:
        mark = self._mark(layer, Marker.CYLINDER, state)
        mark.pose.position.x, mark.pose.position.y = x, y
        mark.scale.x = mark.scale.y = 2.0 * radius_m
        mark.scale.z = 0.02
        mark.text = words

    def arrow(self, layer: str, x: float, y: float, yaw_rad: float, state: Verdict, words: str) -> None:
        mark = self._mark(layer, Marker.ARROW, state)
        mark.pose.position.x, mark.pose.position.y = x, y
        mark.pose.orientation.z, mark.pose.orientation.w = math.sin(0.5 * yaw_rad), math.cos(0.5 * yaw_rad)
        mark.scale.x, mark.scale.y, mark.scale.z = 0.5, 0.08, 0.08
        mark.text = words

    def line(self, layer: str, points: list[tuple[float, float]], state: Verdict) -> None:
        mark = self._mark(layer, Marker.LINE_STRIP, state)
        mark.scale.x = 0.03
        mark.points = [Point(x=x, y=y) for x, y in points]

    def _mark(self, layer: str, kind: int, state: Verdict) -> Any:
        mark = Marker(ns=layer, id=len(self.array.markers), type=kind, action=Marker.ADD)
        mark.header.frame_id, mark.header.stamp = self._frame, self._stamp
        mark.pose.orientation.w = 1.0
        red, green, blue = _COLOURS[state]
        mark.color = ColorRGBA(r=red, g=green, b=blue, a=0.9)
        self.array.markers.append(mark)
        return mark

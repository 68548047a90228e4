"""Leaf: remember a waypoint and its half-plane (P and H^k of the paper)."""

from __future__ import annotations

from typing import Literal

from explore_bt.exploration import HalfPlane, HalfPlaneHistory
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Waypoint

__all__ = ["RecordWaypoint"]


class RecordWaypoint(Leaf):
    """Records the reference pose of the waypoint just reached, and its forward half-plane.

    Source: the paper's "for every waypoint the reference pose should be recorded", and H^k.
    """

    type_key = "record_waypoint"
    values = (HalfPlane, HalfPlaneHistory)

    place: Input[str] = Input(
        Literal["goal", "here"], default="goal", doc="the goal that was driven to, or where the robot stands"
    )
    goal: Input[Waypoint | None] = Input(
        Waypoint, default=Key("goal"), initial=None, doc="the waypoint to record"
    )
    visited: Output[tuple[Waypoint, ...]] = Output(
        tuple, default=Key("visited"), doc="all waypoints so far, oldest first"
    )
    history: Output[HalfPlaneHistory] = Output(
        HalfPlaneHistory, default=Key("half_planes"), doc="half-planes since the last reset"
    )

    def update(self) -> Status:
        """Append to both memories."""
        here = self.robot.estimate().T_map_base
        goal = None if self.place == "here" else self.goal
        waypoint = goal or Waypoint(here, "where the mission began")
        visited = self.recall("visited", ())
        self.visited = (*visited, waypoint)
        history = self.recall("history", HalfPlaneHistory())
        self.history = history.push(HalfPlane.ahead_of(waypoint.pose))
        x, y = waypoint.position
        self.say(f"waypoint {len(visited)} at ({x:.1f}, {y:.1f})")
        return Status.SUCCESS

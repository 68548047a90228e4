"""A robot's place in the team of its mission."""

from __future__ import annotations

from collections.abc import Callable

from explore_bt.fleet import Alone, TeamLink
from explore_bt.interfaces import Slam
from explore_bt.mission import Mission

__all__ = ["team_place"]


def team_place(
    mission: Mission, robot: str, slam: Slam, tell: Callable[[str, str, str], None]
) -> Alone | TeamLink:
    """Its link to the others, over plugins of its own; nothing is opened yet."""
    if mission.team is None:
        return Alone(robot)
    return TeamLink(robot, mission.team.team.make(), mission.team.allocator.make(), slam, tell)

"""A robot's place in the team of its mission, and what it tells there of itself."""

from __future__ import annotations

from collections.abc import Callable

from explore_bt.fleet import Alone, Presence, TeamLink
from explore_bt.interfaces import Driver, HeldBy, Slam
from explore_bt.mission import Mission
from explore_bt.runtime.pilot import Pilot
from explore_bt.types import Estimate

__all__ = ["give_word", "presence_of", "team_place"]


def team_place(
    mission: Mission, robot: str, slam: Slam, driver: Driver, tell: Callable[[str, str, str], None]
) -> Alone | TeamLink:
    """Its link to the others, over plugins of its own; nothing is opened yet."""
    if mission.team is None:
        return Alone(robot)
    # a simulation of one robot alone knows nothing of its mates' bodies
    sees_mates = driver.shows_mates and not (mission.solo is not None and driver.is_simulated)
    team, allocator = mission.team.team.make(), mission.team.allocator.make()
    return TeamLink(robot, team, allocator, slam, tell, sees_mates)


def give_word(pilot: Pilot, team: Alone | TeamLink, now_s: float) -> None:
    """A robot that waits is to stay where it is for as long as words are under way.

    Mates then pass it closely: else it might have set off since it spoke, and two that stand side by side
    where words are slow would hold each other for ever. It waits if it has no path to follow, or is held for
    a mate that goes first; so of two that are held for one another one gives its word.
    """
    if team.lag_s > 0.0 and pilot.is_at_rest and (not pilot.is_following or _lets_pass(pilot, team)):
        pilot.stay(now_s + team.lag_s)


def _lets_pass(pilot: Pilot, team: Alone | TeamLink) -> bool:
    if pilot.held_by is not HeldBy.MATE:
        return False
    before = {mate.name for mate in team.near if mate.right_of_way < team.right_of_way}
    return pilot.in_the_way in before


def presence_of(
    pilot: Pilot, estimate: Estimate, radius_m: float, speed_mps: float, now_s: float, dt_s: float
) -> Presence:
    """Where the robot is, where it passes if it brakes now, and where its path leads.

    Args:
        pilot: knows how it moves.
        estimate: the newest.
        radius_m: of its footprint.
        speed_mps: its limit.
        now_s: the time.
        dt_s: until its next word.
    """
    here = pilot.predict(estimate, now_s).T_map_base
    stop, ahead = pilot.stop_places(here, dt_s), pilot.places_ahead(here)
    binding_s = max(now_s + dt_s, pilot.stays_until_s)
    return Presence(now_s, binding_s, here, pilot.motion.twist, radius_m, speed_mps, stop, ahead)

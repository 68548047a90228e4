"""Built-in teams: ``local``, ``zenoh``; built-in allocators: ``auction``, ``greedy``, ``independent``."""

from __future__ import annotations

from explore_bt import hookimpl
from explore_bt_teams.auction import Auction, AuctionOptions
from explore_bt_teams.greedy import Greedy
from explore_bt_teams.independent import Independent
from explore_bt_teams.local import LocalTeam
from explore_bt_teams.options import TeamOptions
from explore_bt_teams.zenoh_team import ZenohOptions, ZenohTeam

__all__ = [
    "Auction",
    "AuctionOptions",
    "Greedy",
    "Independent",
    "LocalTeam",
    "TeamOptions",
    "ZenohOptions",
    "ZenohTeam",
    "explore_bt_register",
]


@hookimpl
def explore_bt_register() -> list[type]:
    """The teams and allocators of this family."""
    return [LocalTeam, ZenohTeam, Auction, Greedy, Independent]

"""Options of team plugins."""

from __future__ import annotations

from pydantic import Field

from explore_bt.interfaces import PluginOptions

__all__ = ["TeamOptions"]


class TeamOptions(PluginOptions):
    """Which fleet, and how much a robot may say."""

    fleet: str = Field(
        "explore-bt", pattern=r"[A-Za-z0-9_-]+", description="robots of other fleets are not heard"
    )
    bandwidth: float = Field(
        20_000.0,
        ge=2_000.0,
        le=1e8,
        description="bytes a robot may send in a second, in the long run: presence first, then map tiles",
    )

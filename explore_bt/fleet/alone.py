"""The team of a robot that is alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from explore_bt.fleet.team_map import TeamMap
from explore_bt.interfaces import API_VERSION, Allocator, MateFrame, Offers, PluginOptions, RobotContext
from explore_bt.types import Doing, MapFit, Mate, OccupancyGrid, Pose2, Scan2D

__all__ = ["Alone", "Everything"]


class Everything(Allocator):
    """All work is the asker's."""

    name = "everything"
    api_version = API_VERSION
    heeds_claims: ClassVar[bool] = False

    def allot(self, offers: Offers) -> Sequence[int]:
        """All."""
        return range(len(offers.gains_m2))


class Alone:
    """Has nobody to tell anything to; the null object of ``TeamLink``, and ``TeamServices`` for tests."""

    yields = 0
    lag_s = 0.0
    is_paused = False

    def __init__(self, name: str = "robot", allocator: Allocator | None = None) -> None:
        self.name = name
        self.allocator = allocator or Everything(PluginOptions())
        self.mates: tuple[Mate, ...] = ()
        self.claims: tuple[tuple[float, float], ...] = ()
        self.doing = Doing.AT_WORK

    @property
    def right_of_way(self) -> tuple[int, str]:
        """Against that of a mate."""
        return (self.yields, self.name)

    @property
    def near(self) -> tuple[Mate, ...]:
        """Nobody."""
        return self.mates

    def setup(self, context: RobotContext, team_map: TeamMap) -> None:
        """Nothing to join."""

    def chart(self, mate: str) -> MapFit | None:  # noqa: ARG002  # as of ``TeamLink``
        """Nobody else draws."""
        return None

    def frames(self) -> tuple[MateFrame, ...]:
        """Nobody was heard."""
        return ()

    def not_merged(self) -> Mapping[str, str]:
        """Nobody is left out."""
        return {}

    def see(self, scan: Scan2D, pose: Pose2) -> None:
        """Nobody is looked for."""

    def receive(self, now_s: float) -> None:
        """Nobody speaks."""

    def send(self, now_s: float, presence: object, grid: OccupancyGrid) -> None:
        """Nobody listens."""

    def claim(self, places: Sequence[tuple[float, float]]) -> None:
        """Remember them in ``claims``."""
        self.claims = tuple(places)

    def say_doing(self, doing: Doing) -> None:
        """Remember it in ``doing``."""
        self.doing = doing

    def insist(self, until_s: float) -> None:
        """Nobody is in the way."""

    def memory(self) -> Mapping[str, object]:
        """Nothing was told."""
        return {}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Nobody has to be told again."""

    def sum_up(self) -> None:
        """Nothing was told."""

    def close(self) -> None:
        """Nothing to leave."""

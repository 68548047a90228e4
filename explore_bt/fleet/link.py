"""One robot's end of the team: tells what it does and sees, hears what the others do and see."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from explore_bt.fleet.clocks import Clocks, WordAges
from explore_bt.fleet.graph_messages import Fits
from explore_bt.fleet.merger import Merger
from explore_bt.fleet.messages import Message, MessageError, Presence, decode, encode
from explore_bt.fleet.roster import Roster
from explore_bt.fleet.team_map import TeamMap
from explore_bt.fleet.tiles import TileCutter
from explore_bt.interfaces import Allocator, MateFrame, RobotContext, Slam, Team
from explore_bt.types import (
    Doing,
    MapFit,
    Mate,
    OccupancyGrid,
    Pose2,
    Scan2D,
    SharedKeyframe,
    SharedStretch,
)

__all__ = ["NEAR_S", "TeamLink"]

NEAR_S = 2.0
"""Who was heard of so lately is kept clear of by what it told; anybody else as somebody unknown."""
_CLOCKS_PERIOD_S = 1.0
_SPARE_S = 0.2
"""A word is driven by until the next one comes, and one or two may be lost."""
_RESUMED_MS = 10_000
"""A run that goes on may have to begin up to 5 s before where it broke off: its tiles count as newer all the
same."""
_TILES_PERIOD_S = 0.5
_BURST_S = 2.0
_INSISTS = -1
PRESENCE, TILE, CLOCKS, GRAPH = "presence", "tile", "clocks", "graph"


class TeamLink:
    """``TeamServices`` over a team plugin.

    Args:
        name: the robot's.
        team: carries the bytes.
        allocator: divides the work.
        slam: whose map is told.
        tell: takes level, source and message of an event.
        sees_mates: whether scans show them.

    Attributes:
        is_paused: it stands until somebody lets it go on: it tells neither claims nor a way ahead.
    """

    def __init__(
        self,
        name: str,
        team: Team,
        allocator: Allocator,
        slam: Slam,
        tell: Callable[[str, str, str], None],
        sees_mates: bool = True,
    ) -> None:
        self.name = name
        self.allocator = allocator
        self._team = team
        self._slam = slam
        self._tell = tell
        self._roster = Roster()
        self._ages = WordAges(name, time.time_ns())  # of two lives of a robot; no decision hangs on it
        self._compared_s = -_CLOCKS_PERIOD_S
        self._revision_base = 0
        self._cutter = TileCutter()
        self._merger = Merger(slam, TeamMap(slam), RobotContext(), tell)
        self._sees_mates = sees_mates
        self._queue: dict[str, tuple[str, Message]] = {}
        self._cut_revision = -1
        self._cut_s = -_TILES_PERIOD_S
        self._allowance = self._filled_s = 0.0
        self._now_s = 0.0
        self._claims: tuple[tuple[float, float], ...] = ()
        self._doing = Doing.AT_WORK
        self.is_paused = False
        self._insists_until_s = -1.0
        self._strangers: set[str] = set()
        self._present: frozenset[str] = frozenset()
        self._sent = {PRESENCE: 0, TILE: 0, CLOCKS: 0, GRAPH: 0}
        self._began_s: float | None = None

    # --- TeamServices ---------------------------------------------------------------------------------

    @property
    def mates(self) -> tuple[Mate, ...]:
        """The other robots that were heard of a moment ago, by name."""
        return self._roster.present(self._now_s)

    @property
    def near(self) -> tuple[Mate, ...]:
        """Those of them whose word is fresh enough to drive by."""
        return self._roster.present(self._now_s, NEAR_S)

    @property
    def yields(self) -> int:
        """Below 0 while it insists."""
        return _INSISTS if self._now_s < self._insists_until_s else 0

    @property
    def right_of_way(self) -> tuple[int, str]:
        """Against that of a mate."""
        return (self.yields, self.name)

    @property
    def claims(self) -> tuple[tuple[float, float], ...]:
        """Where the robot goes to look, as it tells: nowhere while it is paused."""
        return () if self.is_paused else self._claims

    @property
    def doing(self) -> Doing:
        """What the robot is about, as it tells."""
        return Doing.PAUSED if self.is_paused else self._doing

    @property
    def lag_s(self) -> float:
        """How old the words are that are driven by, at most; 0 alone, or where all have one clock."""
        if self._team.shares_clock or not self._present:
            return 0.0
        return min(self._ages.recent_s + _SPARE_S, NEAR_S)

    def claim(self, places: Sequence[tuple[float, float]]) -> None:
        """Told with the next presence."""
        self._claims = tuple(places)

    def say_doing(self, doing: Doing) -> None:
        """Told with the next presence."""
        self._doing = doing

    def insist(self, until_s: float) -> None:
        """Told with the next presence."""
        self._insists_until_s = until_s

    # --- what the robot calls -------------------------------------------------------------------------

    def setup(self, context: RobotContext, team_map: TeamMap) -> None:
        """Join; what others see goes into ``team_map``."""
        self._merger = Merger(self._slam, team_map, context, self._tell)
        self._revision_base = _RESUMED_MS * (context.resumed.part - 1) if context.resumed else 0
        self._team.setup(context)

    def chart(self, mate: str) -> MapFit | None:
        """How a mate's map lies in one's own; None if it is not merged with it."""
        return self._merger.frames.chart(mate)

    def frames(self) -> tuple[MateFrame, ...]:
        """For observers: everybody who was heard, and where their maps lie."""
        return self._merger.known

    def not_merged(self) -> Mapping[str, str]:
        """The mates whose maps are not merged with one's own, with the reason."""
        return self._merger.frames.why_not()

    def see(self, scan: Scan2D, pose: Pose2) -> None:
        """A scan in which mates are seen where they say they are, or are not; ``pose`` is ``T_map_base``."""
        if self._sees_mates:
            self._merger.see(scan, pose, self.near)

    def receive(self, now_s: float) -> None:
        """Take in what the others have said."""
        self._now_s = now_s
        for letter in self._team.hear():
            try:
                message = decode(letter.payload)
            except MessageError as fault:
                if letter.sender not in self._strangers:
                    self._strangers.add(letter.sender)
                    self._tell("warning", "team", f"robot {letter.sender} is not understood: {fault}")
                continue
            self._take(letter.sender, message)
        self._tell_of_comings()
        self._merger.look(now_s, sorted(self._present))

    def send(self, now_s: float, presence: Callable[[], Presence], grid: OccupancyGrid) -> None:
        """Tell where the robot is, and as many changed tiles as the budget allows.

        Args:
            now_s: its stamp.
            presence: tells it, without claims, doing and priority, which the link knows.
            grid: the robot's own map.
        """
        if self._began_s is None:
            self._began_s = self._filled_s = now_s
        budget = self._team.budget_bytes_per_s
        self._allowance = min(self._allowance + budget * (now_s - self._filled_s), budget * _BURST_S)
        self._filled_s = now_s
        told = replace(
            presence(),
            claims=self.claims,
            doing=self.doing,
            yields=self.yields,
            knows_start=self._merger.knows_start,
            shares_graph=self._merger.shares_graph,
        )
        if self.is_paused:
            told = replace(told, ahead=np.empty((0, 2)))
        self._say(PRESENCE, PRESENCE, encode(told), often=True)
        if not self._team.shares_clock and now_s - self._compared_s > _CLOCKS_PERIOD_S - 1e-6:
            self._compared_s = now_s
            self._say(CLOCKS, CLOCKS, encode(self._ages.tell()))
        self._cut(grid, now_s)
        while self._queue and self._allowance > 0.0:
            topic = next(iter(self._queue))
            kind, message = self._queue.pop(topic)
            self._say(kind, topic, encode(message))

    def sum_up(self) -> None:
        """Tell the observers how much was told."""
        figures = self.figures()
        kinds = (PRESENCE, TILE, GRAPH)
        parts = (f"{kind} {figures[f'{kind}_bytes_per_s'] / 1000.0:.1f} kB/s" for kind in kinds)
        budget = self._team.budget_bytes_per_s / 1000.0
        waiting = f", {len(self._queue)} messages wait" if self._queue else ""
        mean_s, most_s = figures["word_age_mean_s"], figures["word_age_most_s"]
        ages = f"; words came {mean_s:.2f} s old, {most_s:.2f} s at most" if most_s else ""
        self._tell("info", "team", f"told {', '.join(parts)} of {budget:.0f} kB/s{waiting}{ages}")
        for mate, why in self.not_merged().items():
            self._tell("warning", "team", f"the map of robot {mate} is not merged: {why}")

    def memory(self) -> Mapping[str, object]:
        """What the robot has told about its work."""
        return {"claims": self._claims, "doing": str(self._doing)}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Tell it again."""
        self._claims = cast("tuple[tuple[float, float], ...]", memory["claims"])
        self._doing = Doing(str(memory["doing"]))

    def close(self) -> None:
        """Leave."""
        self._team.close()

    def figures(self) -> Mapping[str, float]:
        """Bytes per second of mission time, by what they were for; and what the plugin counts itself."""
        span_s = max(self._now_s - (self._began_s or 0.0), 1.0)
        own = {f"{kind}_bytes_per_s": count / span_s for kind, count in self._sent.items()}
        return {**own, **self._ages.figures(), **self._team.figures()}

    # --- inside -----------------------------------------------------------------------------------------

    def _take(self, sender: str, message: Message) -> None:
        if isinstance(message, Clocks):
            self._ages.hear(sender, message)
        elif isinstance(message, Presence):
            told_s, way = self._told_s(sender, message.stamp_s), self._merger.hear(sender, message)
            self._roster.take(sender, message, self._now_s, told_s, way)
        else:
            self._merger.take(sender, message)

    def _told_s(self, sender: str, stamp_s: float) -> float:
        """When what is heard now was told, on the robot's own clock, at the earliest."""
        if self._team.shares_clock:
            return stamp_s
        return self._now_s - self._ages.bound_s(sender, stamp_s, self._now_s)

    def _say(self, kind: str, topic: str, payload: bytes, *, often: bool = False) -> None:
        say = self._team.say_often if often else self._team.say
        say(topic, payload)
        self._sent[kind] += len(payload)
        self._allowance -= len(payload)

    def _cut(self, grid: OccupancyGrid, now_s: float) -> None:
        """What waits is replaced by what is newer, at its old place in the queue; the graph goes first."""
        if now_s - self._cut_s < _TILES_PERIOD_S - 1e-6:
            return
        self._cut_s = now_s
        graph = {_topic(message): (GRAPH, message) for message in self._merger.fresh()}
        self._queue = {**graph, **self._queue, **graph}
        if grid.revision == self._cut_revision:
            return
        window = None if self._cut_revision < 0 else self._slam.changed_since(self._cut_revision)
        for tile in self._cutter.changed(grid, window, round(1000 * now_s) + self._revision_base):
            self._queue[f"{TILE}/{tile.place[0]}/{tile.place[1]}"] = (TILE, tile)
        self._cut_revision = grid.revision

    def _tell_of_comings(self) -> None:
        present = self._roster.heard(self._now_s)
        for name in sorted(present - self._present):
            self._tell("info", "team", f"robot {name} is there")
        for name in sorted(self._present - present):
            self._tell("warning", "team", f"robot {name} is silent: what it had claimed is free")
        self._present = present


def _topic(message: SharedKeyframe | SharedStretch | Fits) -> str:
    if isinstance(message, Fits):
        return "fits"
    return f"{'keyframe' if isinstance(message, SharedKeyframe) else 'stretch'}/{message.number}"

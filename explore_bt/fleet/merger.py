"""What makes one map of those of the team: frames that are believed, tiles laid into them, doubts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from collections.abc import Set as AbstractSet

from explore_bt.fleet.doubts import Unseen, quarrel
from explore_bt.fleet.frames import Frames
from explore_bt.fleet.graph_messages import Fits
from explore_bt.fleet.graph_teller import GraphTeller
from explore_bt.fleet.messages import Presence, Tile
from explore_bt.fleet.team_map import TeamMap
from explore_bt.interfaces import MateFrame, RobotContext, Slam
from explore_bt.types import MapFit, Mate, Pose2, Scan2D, SharedKeyframe, SharedStretch

__all__ = ["Merger"]

_QUARREL_PERIOD_S = 1.0


class Merger:
    """Keeps to what ``Frames`` decides, and brings it what closures, maps and scans say.

    Args:
        slam: one's own.
        team_map: where the mates' tiles go.
        context: of the robot that is set up.
        tell: takes level, source and message of an event.

    Attributes:
        frames: who is believed.
    """

    def __init__(
        self, slam: Slam, team_map: TeamMap, context: RobotContext, tell: Callable[[str, str, str], None]
    ) -> None:
        self._slam, self._map = slam, team_map
        self._share = slam.graph_share()
        self._teller = GraphTeller(self._share)
        self._unseen, self._radius_m = Unseen(), context.footprint_radius_m
        self._judged_s = 0.0
        self._passed: set[str] = set()
        self._name = context.robot
        self._told_fits: AbstractSet[str] = frozenset()
        self._turn = 0
        self.knows_start = context.knows_start
        self.frames = Frames(context.knows_start, self._share, tell)

    @property
    def known(self) -> tuple[MateFrame, ...]:
        """For observers: everybody who was heard, and where their maps lie."""
        return self.frames.known(self._passed)

    @property
    def shares_graph(self) -> bool:
        """Whether there are keyframes to tell of."""
        return self._share.can_find

    def fresh(self) -> Iterator[SharedKeyframe | SharedStretch | Fits]:
        """What of the graph has to be told; with whom it is joined only when that changes, it is a hint."""
        yield from self._teller.fresh()
        found = self.frames.found()
        if found.T_ours_theirs.keys() != self._told_fits:
            self._told_fits = found.T_ours_theirs.keys()
            yield found

    def take(self, sender: str, message: Tile | SharedKeyframe | SharedStretch | Fits) -> None:
        """A mate tells what it has seen."""
        if isinstance(message, Tile):
            self._map.put(sender, message)
        elif isinstance(message, Fits):
            if self._name in message.T_ours_theirs:
                self.frames.hint(sender, message.T_ours_theirs[self._name].inverse())
        else:
            self._share.take(sender, message)

    def hear(self, sender: str, told: Presence) -> MapFit | None:
        """A mate tells where it is: how its map lies in one's own, None if nobody knows."""
        self.frames.hear(sender, told)
        return self.frames.way(sender)

    def see(self, scan: Scan2D, pose: Pose2, mates: Sequence[Mate]) -> None:
        """A scan in which mates are seen where they say they are, or are not; ``pose`` is ``T_map_base``."""
        for name, why in self._unseen.look(scan, pose, mates, self._radius_m).items():
            self.frames.refuse(name, why)

    def look(self, now_s: float, names: Sequence[str]) -> None:
        """Find out how the maps of the mates lie, and lay them there unless they quarrel with one's own."""
        self._share.look()
        self.frames.look()
        if names and now_s - self._judged_s > _QUARREL_PERIOD_S - 1e-6:
            self._judged_s, self._turn = now_s, self._turn + 1
            self._judge(names[self._turn % len(names)])
        for name in names:
            if self.frames.chart(name) is None:
                self._passed.discard(name)
            elif name not in self._passed:
                self._judge(name)
            self._map.lay(name, self.frames.chart(name) if name in self._passed else None)
        self.frames.tell_news(self._passed)

    def _judge(self, name: str) -> None:
        """Nothing is merged that has not passed this once."""
        chart = self.frames.chart(name)
        mosaic = None if chart is None else self._map.seen_by(name, chart)
        if mosaic is None:
            return
        if why := quarrel(self._slam.grid(), mosaic):
            self.frames.refuse(name, why)
        else:
            self._passed.add(name)

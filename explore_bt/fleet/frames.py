"""Whose word about places is believed: how the map of each team mate lies in one's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from explore_bt.fleet.graph_messages import Fits
from explore_bt.fleet.messages import Presence
from explore_bt.interfaces import GraphShare, MateFrame
from explore_bt.types import MapFit, Pose2

__all__ = ["SAME", "Frames"]

SAME = MapFit.rigid(Pose2.identity())
"""Two robots whose starts were given in one frame."""
_WRONG_M, _WRONG_RAD = 0.3, math.radians(5.0)


@dataclass
class _Mate:
    """What is known about one of them.

    Attributes:
        is_told: its start was given, and one's own.
        is_checkable: both tell and take keyframes.
        refused: why its map is not what it seemed; empty while nothing speaks against it.
        is_doubted: closures speak against its start, though they prove nothing yet.
        fit: what closures say.
        said: what was last told about it.
    """

    is_told: bool = False
    is_checkable: bool = False
    refused: str = ""
    is_doubted: bool = False
    fit: MapFit | None = None
    said: str = ""


class Frames:
    """Decides, mate by mate, from given starts, from closures, and from what speaks against either.

    A start that was given is good enough to keep clear of a mate and to divide the work by. Maps are merged
    when closures say how they lie; by given starts alone only where SLAM finds no closures with others.

    Args:
        knows_start: whether one's own start was given.
        share: finds closures with mates.
        tell: takes level, source and message of an event.
    """

    def __init__(self, knows_start: bool, share: GraphShare, tell: Callable[[str, str, str], None]) -> None:
        self._knows_start = knows_start
        self._share = share
        self._tell = tell
        self._mates: dict[str, _Mate] = {}

    def hear(self, name: str, told: Presence) -> None:
        """What a mate says about its own frame."""
        mate = self._mates.setdefault(name, _Mate())
        mate.is_checkable = self._share.can_find and told.shares_graph
        is_told = self._knows_start and told.knows_start
        if is_told and not mate.is_told and mate.is_checkable and not mate.refused:
            self._share.expect(name, Pose2.identity())
        mate.is_told = is_told

    def hint(self, name: str, T_ours_theirs: Pose2) -> None:
        """A mate has found out how the maps lie: where to look first for what says so too."""
        mate = self._mates.setdefault(name, _Mate())
        if mate.fit is None and not mate.refused:
            self._share.expect(name, T_ours_theirs)

    def found(self) -> Fits:
        """How the maps of mates lie, as closures have told it."""
        return Fits({name: _about(mate.fit) for name, mate in self._mates.items() if mate.fit is not None})

    def look(self) -> None:
        """Ask for what closures say by now."""
        for name, mate in self._mates.items():
            if mate.is_checkable:
                mate.fit, mate.is_doubted = self._share.fit(name), self._share.doubts(name)
                if mate.fit is not None:
                    mate.refused = ""

    def way(self, name: str) -> MapFit | None:
        """How the mate's map lies, to drive and to divide work by; None: it is a stranger."""
        mate = self._mates.get(name)
        if mate is None:
            return None
        is_good = mate.is_told and not mate.refused and not mate.is_doubted
        return mate.fit or (SAME if is_good else None)

    def chart(self, name: str) -> MapFit | None:
        """How the mate's map lies, to be merged with one's own; None: not yet, or not at all."""
        mate = self._mates.get(name)
        if mate is None or mate.is_checkable:
            return None if mate is None else mate.fit
        return self.way(name)

    def known(self, merged: AbstractSet[str]) -> tuple[MateFrame, ...]:
        """For observers: everybody who was heard, and where their maps lie."""
        return tuple(self._known(name, name in merged) for name in sorted(self._mates))

    def _known(self, name: str, is_merged: bool) -> MateFrame:
        way, is_drawn = self.way(name), is_merged and self.chart(name) is not None
        T = None if way is None else _rounded(_about(way))
        return MateFrame(name, T, "" if is_drawn else self._reason(name))

    def refuse(self, name: str, why: str) -> None:
        """Something speaks against what is believed about a mate."""
        mate = self._mates[name]
        mate.refused, mate.fit = why, None
        self._share.refuse(name)

    def why_not(self) -> Mapping[str, str]:
        """The mates whose maps are not merged, with the reason."""
        return {name: self._reason(name) for name in sorted(self._mates) if self.chart(name) is None}

    def tell_news(self, merged: AbstractSet[str]) -> None:
        """Tell the observers who is merged now, and who is not any more."""
        for name in sorted(self._mates):
            mate, is_merged = self._mates[name], name in merged and self.chart(name) is not None
            words = self._merged(mate) if is_merged else mate.refused
            if words == mate.said or (not words and not mate.said):
                continue
            mate.said = words
            level = "info" if is_merged else "warning"
            state = "merged" if is_merged else "not merged"
            self._tell(level, "team", f"robot {name} is {state}: {words or self._reason(name)}")

    def _reason(self, name: str) -> str:
        mate = self._mates[name]
        if mate.refused:
            return mate.refused
        if mate.is_checkable:
            start = "its start is to be checked" if mate.is_told else "nobody has said where it began"
            start = "its start seems to be wrong" if mate.is_told and mate.is_doubted else start
            return f"{start}; {self._share.why_not(name)}"
        return "nobody has said where it began, and no SLAM of the two finds out"

    def _merged(self, mate: _Mate) -> str:
        if mate.fit is None:
            return "its start was given"
        if not mate.is_told:
            return "closures have told where it began"
        off = mate.fit.at_theirs(*mate.fit.theirs[0, :2].tolist())
        x, y, yaw = mate.fit.theirs[0].tolist()
        off_m = math.dist(off.compose(Pose2(x, y, yaw)).xy, (x, y))
        if off_m < _WRONG_M and abs(off.yaw_rad) < _WRONG_RAD:
            return "closures agree with the start that was given"
        return (
            f"closures put the start that was given {off_m:.1f} m and "
            f"{math.degrees(abs(off.yaw_rad)):.0f} deg off"
        )


def _about(fit: MapFit) -> Pose2:
    """``T_ours_theirs`` about where the mate was last."""
    x, y, _ = fit.theirs[-1].tolist()
    return fit.at_theirs(x, y)


def _rounded(pose: Pose2) -> Pose2:
    """So that it is not news with every keyframe."""
    return Pose2(round(pose.x, 2), round(pose.y, 2), round(pose.yaw_rad, 3))

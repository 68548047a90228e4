"""What ties a robot's map to that of one team mate."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MapFit, Pose2, SharedEdge, SharedKeyframe, SharedStretch, wrap_angle
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.consistency import largest_consistent
from explore_bt_slam.far_closures import FarClosureFinder, Sighting
from explore_bt_slam.graph_distance import relative_covariances
from explore_bt_slam.guests import guest_key
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.mate_graph import MateGraph
from explore_bt_slam.mate_search import MateSearch
from explore_bt_slam.mate_verdict import contradiction, is_contradicted
from explore_bt_slam.point_to_line import Alignment
from explore_bt_slam.pose_graph import Edge, closure_edge

__all__ = ["MateBond"]

_NEAR_M = 2.5
_APART_M = 1.0
_AGREEING, _SPAN_M = 3, 3.0
"""So many closures over so much way must say the same, as of a robot's own."""
_EXTENT_M = 3.5
"""And, as nobody had said how the maps lie, so far apart: what repeats from room to room shows by then."""
_AGREEING_TOLD, _SPAN_TOLD_M = 3, 0.5
"""And where they say what somebody had said: to find that by chance is another matter."""
_REMEMBERED = 40
_AS_TOLD_M, _AS_TOLD_RAD = 0.3, 0.1
_REFUSED_M, _REFUSED_RAD = 1.0, 0.3
_LATELY = 24
_LEAST_POINTS = 40
_DOUBT_KEYFRAMES = 6


class MateBond:
    """Closures with one mate: found, agreed upon, and put into one graph of both.

    Args:
        number: of the mate among all, from 0.

    Attributes:
        is_doubtful: two closures agree that the maps do not lie as was said.
    """

    def __init__(self, number: int) -> None:
        self._number = number
        self._told: Pose2 | None = None
        self.is_doubtful = False
        self._wrong: list[MapFit] = []
        self._mate = MateGraph()
        self._search = MateSearch()
        self._theirs, self._ours = FarClosureFinder(), FarClosureFinder()
        self._pending: list[Edge] = []
        self._followed = -1
        self._looked_at = self._admitted = self._judged_from = self._checked = 0
        self._edges: dict[tuple[float, ...], Edge] = {}
        self._lately: deque[bool] = deque(maxlen=_LATELY)
        self._fit: MapFit | None = None
        self._fit_of: tuple[NDArray[np.float64], NDArray[np.float64]] = (np.zeros(0), np.zeros(0))

    @property
    def is_tied(self) -> bool:
        """Whether the mate's keyframes are in the graph."""
        return self._admitted > 0

    @property
    def evidence(self) -> int:
        """How many closures wait for others that say the same."""
        return len(self._pending)

    def expect(self, T_ours_theirs: Pose2) -> None:
        """See ``GraphShare.expect``."""
        self._told, self._checked = T_ours_theirs, 0

    def take(self, told: SharedKeyframe | SharedStretch, back: BackEnd) -> None:
        """See ``GraphShare.take``; a mate that has begun anew is a stranger."""
        known = self._mate.keyframes
        if isinstance(told, SharedKeyframe) and told.number < len(known):
            if known[told.number].stamp_s != told.stamp_s:
                self.let_go(back)
                self._mate, self._theirs = MateGraph(), FarClosureFinder()
                self._checked, self._followed = 0, -1
            else:
                return
        self._mate.take(told)

    def look(self, back: BackEnd) -> None:
        """A little of whatever there is to do."""
        if not back.keyframes or not self._mate.keyframes:
            return
        is_new = len(back.keyframes) > self._looked_at
        self._looked_at = len(back.keyframes)
        if self.is_tied:
            self._follow(back)
            if is_new:
                self._offer(back, self._closures_here(back))
                self._doubt(back)
            return
        if self._told is not None:
            self._check(back, self._told, is_new)
        if not self.is_tied and (edge := self._search.step(back.keyframes, back.poses, self._mate)):
            self._weigh(back, [edge])

    def fit(self, back: BackEnd) -> MapFit | None:
        """See ``GraphShare.fit``."""
        if not self.is_tied:
            return None
        of = (back.poses, self._mate.poses)
        if self._fit is None or self._fit_of[0] is not of[0] or self._fit_of[1] is not of[1]:
            numbers = range(self._admitted)
            ours = np.array([back.pose(self._key(number)).as_array() for number in numbers])
            self._fit, self._fit_of = MapFit(self._mate.poses[: self._admitted], ours), of
        return self._fit

    def refuse(self, back: BackEnd) -> None:
        """See ``GraphShare.refuse``."""
        if (fit := self.fit(back)) is not None:
            self._wrong.append(fit)
        elif self._told is not None:
            self._wrong.append(MapFit.rigid(self._told))
        self._told = None
        self.let_go(back)

    def let_go(self, back: BackEnd) -> None:
        """Take the mate out of the graph; evidence counts from here on."""
        if self.is_tied:
            back.graph.send_off(self._number)
        self._admitted, self._edges = 0, {}
        self._pending, self._fit, self._search = [], None, MateSearch()
        self._lately.clear()

    # --- before anything is believed --------------------------------------------------------------------

    def _check(self, back: BackEnd, told: Pose2, is_new: bool) -> None:
        """Closures as the maps are said to lie: of one's own newest keyframe, and of the mate's."""
        fit, edges = MapFit.rigid(told), []
        if is_new:
            edges += [closure_edge(self._mate.poses, *each) for each in self._fitting(back, fit)]
        while self._checked < len(self._mate.keyframes) and not edges:
            number, self._checked = self._checked, self._checked + 1
            pose = told.compose(self._mate.pose(number))
            scan = self._mate.keyframes[number]
            found = _fitting(self._ours, back.keyframes, back.poses, scan, pose, most=1)
            edges += [_turned(closure_edge(back.poses, place, number, each)) for place, each in found]
        self._weigh(back, edges)

    def _weigh(self, back: BackEnd, edges: Sequence[Edge]) -> None:
        """Note closures from the mate's to one's own keyframes; once enough agree the graphs are one."""
        if not edges:
            return
        spread = relative_covariances(back.poses, back.edges, len(back.keyframes) - 1)
        for edge in edges:
            if any(self._says(edge, back, wrong) for wrong in self._wrong):
                continue
            self._pending = [*self._pending, edge][-_REMEMBERED:]
            agreed = largest_consistent(self._pending, back.poses, spread, self._mate.poses)
            is_other = self._told is not None and not self._is_as_told(agreed, back)
            self.is_doubtful = is_other and len(agreed) > 1
            if self._is_enough(agreed, back):
                self._decide(agreed, back)
                return

    def _decide(self, agreed: Sequence[Edge], back: BackEnd) -> None:
        """Closures that agree are believed unless the rest of the maps speaks against them."""
        fit = self._fit_of_closures(agreed, back)
        share = self._contradiction(back, fit)
        if share is None:
            return
        if is_contradicted(share):
            self._wrong.append(fit)
            self._pending = [edge for edge in self._pending if edge not in agreed]
            return
        self._tie(agreed, back, fit)

    def _contradiction(self, back: BackEnd, fit: MapFit, since: int = 0) -> float | None:
        def moved(number: int) -> Pose2:
            there = mate.pose(number)
            return fit.at_theirs(*there.xy).compose(there)

        mate = self._mate
        return contradiction(back.keyframes, back.poses, mate.keyframes, mate.poses, moved, since)

    def _fit_of_closures(self, edges: Sequence[Edge], back: BackEnd) -> MapFit:
        """As each of them has it, about its place."""
        theirs = np.array([self._mate.poses[edge.a] for edge in edges])
        ours = [back.pose(edge.b).compose(edge.relative.inverse()).as_array() for edge in edges]
        return MapFit(theirs, np.array(ours))

    def _is_enough(self, agreed: Sequence[Edge], back: BackEnd) -> bool:
        is_as_told = self._is_as_told(agreed, back)
        least, span_m = (_AGREEING_TOLD, _SPAN_TOLD_M) if is_as_told else (_AGREEING, _SPAN_M)
        span = max(
            np.ptp([back.keyframes[edge.b].driven_m for edge in agreed]),
            np.ptp([self._mate.keyframes[edge.a].driven_m for edge in agreed]),
        )
        at = back.poses[[edge.b for edge in agreed], :2]
        extent_m = float(np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1)).max())
        if not is_as_told and extent_m < _EXTENT_M:
            return False
        is_majority = 2 * len(agreed) > len(self._pending)
        count = max(len({edge.a for edge in agreed}), len({edge.b for edge in agreed}))
        return is_majority and count >= least and span >= span_m

    def _is_as_told(self, agreed: Sequence[Edge], back: BackEnd) -> bool:
        told = None if self._told is None else MapFit.rigid(self._told)
        return told is not None and all(
            self._says(edge, back, told, _AS_TOLD_M, _AS_TOLD_RAD) for edge in agreed
        )

    def _says(
        self,
        edge: Edge,
        back: BackEnd,
        fit: MapFit,
        off_m: float = _REFUSED_M,
        off_rad: float = _REFUSED_RAD,
    ) -> bool:
        """Whether a closure puts its place about where a fit has it."""
        there = self._mate.pose(edge.a)
        here = back.pose(edge.b).compose(edge.relative.inverse())
        claimed = fit.at_theirs(*there.xy).compose(there)
        turned = abs(wrap_angle(claimed.yaw_rad - here.yaw_rad))
        return here.distance_to(claimed) <= off_m and turned <= off_rad

    def _tie(self, agreed: Sequence[Edge], back: BackEnd, fit: MapFit) -> None:
        """Every keyframe of the mate goes into the graph, where the nearest of the closures puts it."""
        count = len(self._mate.keyframes)
        poses = {}
        for number in range(count):
            there = self._mate.pose(number)
            poses[self._key(number)] = fit.at_theirs(*there.xy).compose(there)
        self._edges = {_name(edge): self._as_guests(edge) for edge in self._mate.edges()}
        ties = [
            Edge(self._key(edge.a), edge.b, edge.relative, edge.covariance, is_closure=True)
            for edge in agreed
        ]
        self._admitted, self._pending = count, []
        self._search = MateSearch()
        self._judged_from = len(back.keyframes)
        back.graph.receive(poses, [*self._edges.values(), *ties])

    # --- in one graph -----------------------------------------------------------------------------------

    def _follow(self, back: BackEnd) -> None:
        """What the mate has told since: more keyframes, more closures of its own, fewer."""
        if self._mate.revision == self._followed:
            return
        self._followed = self._mate.revision
        told = {_name(edge): edge for edge in self._mate.edges()}
        if told.keys() == self._edges.keys():
            return
        gone = [self._edges.pop(name) for name in self._edges.keys() - told.keys()]
        if gone:
            back.graph.loosen(gone)
        fresh = {name: edge for name, edge in told.items() if name not in self._edges}
        steps = [edge for edge in fresh.values() if not edge.is_closure and edge.b >= self._admitted]
        before, self._admitted = self._admitted, len(self._mate.keyframes)
        self._edges |= {name: self._as_guests(edge) for name, edge in fresh.items()}
        for edge in steps:
            start = back.pose(self._key(edge.a)).compose(edge.relative)
            back.graph.follow({self._key(edge.b): start}, [self._edges[_name(edge)]])
        others = [self._edges[name] for name, edge in fresh.items() if edge.is_closure]
        if others:
            back.graph.tie(others)
        for number in range(before, self._admitted):
            self._offer(back, self._closures_there(back, number))

    def _offer(self, back: BackEnd, edges: Sequence[Edge]) -> None:
        """Closures into the graph; a bond that most of them speak against is none."""
        if not edges:
            return
        taken = back.graph.tie(edges)
        self._lately.extend(edge in taken for edge in edges)
        if 2 * self._lately.count(False) >= _LATELY:
            self.let_go(back)

    def _doubt(self, back: BackEnd) -> None:
        """Look at the last metres again, now and then: a bond that they speak against was none."""
        newest, fit = len(back.keyframes), self.fit(back)
        if fit is None or newest - self._judged_from < _DOUBT_KEYFRAMES:
            return
        self._judged_from = newest
        if is_contradicted(self._contradiction(back, fit, newest - 2 * _DOUBT_KEYFRAMES)):
            self.refuse(back)

    def _closures_here(self, back: BackEnd) -> list[Edge]:
        """Of one's own newest keyframe with the mate's."""
        fit = self.fit(back)
        found = [] if fit is None else self._fitting(back, fit)
        edges = [closure_edge(self._mate.poses, *each) for each in found]
        return [Edge(self._key(e.a), e.b, e.relative, e.covariance, is_closure=True) for e in edges]

    def _closures_there(self, back: BackEnd, number: int) -> list[Edge]:
        """Of a keyframe of the mate's with one's own."""
        scan, pose = self._mate.keyframes[number], back.pose(self._key(number))
        found = _fitting(self._ours, back.keyframes, back.poses, scan, pose, most=1)
        edges = [closure_edge(back.poses, place, number, alignment) for place, alignment in found]
        return [Edge(e.a, self._key(e.b), e.relative, e.covariance, is_closure=True) for e in edges]

    def _fitting(self, back: BackEnd, fit: MapFit) -> list[tuple[int, int, Alignment]]:
        """The mate's places about one's newest keyframe that its scan fits, if the maps lie like that."""
        newest = len(back.keyframes) - 1
        pose = back.pose(newest)
        there = fit.at_ours(*pose.xy).inverse().compose(pose)
        found = _fitting(self._theirs, self._mate.keyframes, self._mate.poses, back.keyframes[newest], there)
        return [(place, newest, alignment) for place, alignment in found]

    def _key(self, number: int) -> int:
        return guest_key(self._number, number)

    def _as_guests(self, edge: SharedEdge) -> Edge:
        return Edge(self._key(edge.a), self._key(edge.b), edge.relative, edge.covariance, edge.is_closure)


def _fitting(
    finder: FarClosureFinder,
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    scan: Keyframe,
    pose: Pose2,
    most: int = 2,
) -> list[tuple[int, Alignment]]:
    """The nearest places of a map that a scan fits at about a pose, with how it does."""
    if len(scan.points) < _LEAST_POINTS:
        return []
    distance_m = np.hypot(poses[:, 0] - pose.x, poses[:, 1] - pose.y)
    chosen: list[int] = []
    for index in np.argsort(distance_m, kind="stable").tolist():
        if distance_m[index] > _NEAR_M or len(chosen) == most:
            break
        if all(np.hypot(*(poses[index, :2] - poses[other, :2])) >= _APART_M for other in chosen):
            chosen.append(index)
    fitted = [(place, finder.fitted(keyframes, poses, scan, Sighting(place, pose, 1.0))) for place in chosen]
    return [(place, alignment) for place, alignment in fitted if alignment is not None]


def _turned(edge: Edge) -> Edge:
    """The same constraint, seen from its other end."""
    back = edge.relative.inverse()
    turn = np.eye(3)
    turn[:2, :2] = [
        [math.cos(edge.relative.yaw_rad), -math.sin(edge.relative.yaw_rad)],
        [math.sin(edge.relative.yaw_rad), math.cos(edge.relative.yaw_rad)],
    ]
    turn[:2, 2] = [edge.relative.y, -edge.relative.x]
    return Edge(edge.b, edge.a, back, turn @ edge.covariance @ turn.T, edge.is_closure)


def _name(edge: SharedEdge) -> tuple[float, ...]:
    """Tells a constraint from all others of its robot."""
    return (edge.a, edge.b, edge.relative.x, edge.relative.y, edge.relative.yaw_rad)

"""One robot's tree over a map and a pose."""

from __future__ import annotations

import numpy as np

from explore_bt.headless.decision import Decision
from explore_bt.headless.grid_robot import GridRobot
from explore_bt.mission import NodeSpec, build_tree
from explore_bt.tree import Blackboard, Status
from explore_bt.types import Doing, Mate, OccupancyGrid, Path, Pose2, Twist2, Waypoint

__all__ = ["ExplorerRobot"]

_MOST_TICKS = 1000


class ExplorerRobot:
    """Ticks a tree until it offers a path, or ends."""

    def __init__(self, body: GridRobot, tree: NodeSpec) -> None:
        self._body = body
        self._blackboard = Blackboard()
        self._tree = build_tree(tree, body, self._blackboard)
        self._over: Decision | None = None

    def as_mate(self, pose: Pose2) -> Mate:
        """What the others are told of it."""
        doing = Doing.OVER if self._over else self._body.team.doing
        claims = () if self._over else self._body.team.claims
        stamp_s, nowhere = self._body.now_s(), np.empty((0, 2))
        radius_m = self._body.footprint_radius_m
        return Mate(
            self._body.name, stamp_s, stamp_s, pose, Twist2(), radius_m, 0.0, nowhere, nowhere, claims, doing
        )

    def decide(self, grid: OccupancyGrid, pose: Pose2, mates: tuple[Mate, ...] = ()) -> Decision:
        """Tell the tree where the robot is, and what the others are about; once over, it stays over."""
        if self._over is not None:
            return self._over
        self._body.report(grid, pose)
        self._body.team.mates = mates
        for _ in range(_MOST_TICKS):
            self._tree.root.tick_once()
            if self._tree.root.status is not Status.RUNNING:
                self._over = self._ended(self._tree.root.status)
                return self._over
            ahead = self._body.pilot.path_ahead
            if ahead is not None:
                return self._offer(ahead)
        return Decision(None, None, False, "the tree is still thinking")

    def _offer(self, path: Path) -> Decision:
        goal = self._blackboard.get("goal")
        reason = goal.reason if isinstance(goal, Waypoint) else ""
        return Decision(path.goal, path, False, reason)

    def _ended(self, status: Status) -> Decision:
        left = self._blackboard.get("left_open", ())
        assert isinstance(left, tuple)  # written by a port of that type
        reason = str(self._blackboard.get("reason", ""))
        if not reason:
            leaves = [node for node in self._tree.nodes if node.status is status and not node.children]
            reason = "; ".join(
                dict.fromkeys(leaf.feedback_message for leaf in leaves if leaf.feedback_message)
            )
        return Decision(None, None, True, reason, left)

"""How an exploration is getting on, for those who asked for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from explore_bt.interfaces import NodeInfo, RobotSnapshot

__all__ = ["feedback_of"]


def feedback_of(
    state: str, nodes: Sequence[NodeInfo], robot: RobotSnapshot, stamp_s: float
) -> dict[str, Any]:
    """What goes out on ``~/feedback``, as JSON.

    Args:
        state: ``waiting``, ``exploring``, ``paused`` or ``over``.
        nodes: of the robot's tree.
        robot: after a tick.
        stamp_s: mission time of that tick.
    """
    running = [number for number, node in enumerate(robot.nodes) if node.status == "running"]
    pose = robot.estimate.T_map_base.as_array().tolist()
    free_m2 = float(robot.grid.free.sum()) * robot.grid.resolution_m**2
    return {
        "state": state,
        "time_s": round(stamp_s, 3),
        "doing": nodes[running[-1]].path if running else "",
        "message": robot.nodes[running[-1]].message if running else "",
        "held": robot.gate_reason,
        "pose": [round(each, 3) for each in pose],
        "free_m2": round(free_m2, 2),
        "distance_m": round(robot.score.distance_m, 2),
        "left": {budget.name: round(budget.left, 1) for budget in robot.budgets},
    }

"""Tree, place, blackboard and map as lines of text."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase

import numpy as np
from rich.text import Text

from explore_bt.debug.state import DebugState
from explore_bt.interfaces import NodeInfo, NodeState, RobotSnapshot, TickSnapshot
from explore_bt.recording.values import to_json
from explore_bt.report.live import MapDots, RobotMark
from explore_bt.types import Health, Waypoint

__all__ = ["board_lines", "map_lines", "state_lines", "tree_lines", "value_text", "where_lines"]

_STYLES = {"success": "green", "failure": "bright_red", "running": "bright_cyan", "idle": "grey50"}
_WIDEST_MAP, _TALLEST_MAP = 100, 30


def value_text(value: object) -> str:
    """A value on one line, as the recording has it."""
    return json.dumps(to_json(value), ensure_ascii=False)


def board_lines(board: Mapping[str, object]) -> Iterator[Text]:
    """Every entry with its value."""
    width = max(map(len, board), default=0)
    for key in sorted(board):
        yield Text.assemble((f"${key:<{width}}  ", "bright_cyan"), value_text(board[key]))


def tree_lines(
    infos: Sequence[NodeInfo], nodes: Sequence[NodeState], pattern: str, marked: str
) -> Iterator[Text]:
    """The tree, a node a line; below a node of ``pattern``, if there is one.

    Args:
        infos: parents before children.
        nodes: in the same order.
        pattern: a path with ``*``; empty for the whole tree.
        marked: path of the node paused at.
    """
    depths: dict[int, int] = {}
    shown: set[int] = set()
    for info, state in zip(infos, nodes, strict=True):
        begins = not pattern or fnmatchcase(f"/{info.path}", f"*/{pattern}")
        if not begins and info.parent not in shown:
            continue
        shown.add(info.id)
        depths[info.id] = depths[info.parent] + 1 if info.parent in shown and info.parent is not None else 0
        yield _node_line(info, state, depths[info.id], is_marked=info.path == marked)


def _node_line(info: NodeInfo, state: NodeState, depth: int, *, is_marked: bool) -> Text:
    label = info.name if info.type in (info.name, "timeout", "retry") else f"{info.name} ({info.type})"
    line = Text("> " if is_marked else "  ", "bold bright_yellow")
    line.append("  " * depth)
    line.append(f"{state.status.upper():<7} ", _STYLES.get(state.status, ""))
    line.append(label, "bold" if state.status == "running" else "")
    return line.append(f"  {state.message}", "grey70") if state.message else line


def state_lines(state: DebugState, robots: int) -> Iterator[Text]:
    """Where the run stands, in one line, and at which node, in a second."""
    when = f"tick {state.tick}, {state.stamp_s:.2f} s"
    if state.over:
        yield Text.assemble(("over ", "bold"), f"at {when}: {state.why}")
        return
    yield Text.assemble(("paused " if state.paused else "running ", "bold"), f"at {when}: {state.why}")
    if state.held:
        yield Text(f"  {', '.join(state.held)} stands while the others go on", "yellow")
    if state.paused and not state.is_simulated:
        yield Text("  time goes on: the robots are held, the trees wait", "yellow")
    if state.path:
        name = f"{state.robot}: " if robots > 1 else ""
        yield Text.assemble(
            f"  {name}{state.moment} {state.path}  ", (state.status.upper(), _STYLES[state.status])
        )


def where_lines(
    tick: TickSnapshot,
    robot: RobotSnapshot,
    infos: Sequence[NodeInfo],
    nodes: Sequence[NodeState],
    at: str,
) -> Iterator[Text]:
    """Time, pose, figures, and the branch with its places in the mission.

    Args:
        tick: what is looked at.
        robot: of that tick.
        infos: of its tree; parents before children.
        nodes: in the same order.
        at: path of the node paused at, whose branch is shown; empty for the running branch.
    """
    pose, score = robot.estimate.T_map_base, robot.score
    figures = [
        f"({pose.x:.2f}, {pose.y:.2f}) m, heading {math.degrees(pose.yaw_rad):.0f} deg",
        f"{robot.motion.twist.linear_mps:.2f} m/s",
        f"{score.distance_m:.1f} m driven",
    ]
    figures += [] if score.coverage is None else [f"{100.0 * score.coverage:.1f} % mapped"]
    yield Text(f"tick {tick.index}, {tick.stamp_s:.2f} s  {robot.robot} at {', '.join(figures)}")
    if robot.estimate.health is not Health.OK:
        yield Text(f"SLAM {robot.estimate.health}: {robot.estimate.reason}", "yellow")
    if robot.gate_reason:
        yield Text(f"braking: {robot.gate_reason}", "yellow")
    branch = _branch_to(infos, at) if at else _running(infos, nodes)
    for depth, info in enumerate(branch):
        state = nodes[info.id]
        line = Text(f"{'  ' * depth}{info.name}")
        line.append(f"  {info.place}", "grey50")
        yield line.append(f"  {state.message}", "grey70") if state.message else line


def _branch_to(infos: Sequence[NodeInfo], path: str) -> list[NodeInfo]:
    """From the root to the node of that path."""
    branch = [info for info in infos if info.path == path]
    while (parent := branch[0].parent) is not None:
        branch.insert(0, infos[parent])
    return branch


def _running(infos: Sequence[NodeInfo], nodes: Sequence[NodeState]) -> list[NodeInfo]:
    """Running nodes below running nodes, from the root on."""
    running: dict[int | None, NodeInfo | None] = {None: None}
    for info, state in zip(infos, nodes, strict=True):
        if state.status == "running" and info.parent in running:
            running[info.id] = info
    return [info for info in running.values() if info is not None]


def map_lines(robot: RobotSnapshot, trail: Sequence[tuple[float, float]], width: int) -> list[Text]:
    """The map in small dots, with the way driven, robot and goal."""
    columns = min(max(width - 1, 20), _WIDEST_MAP)
    goal = robot.blackboard.get("goal")
    mark = RobotMark(
        robot.estimate.T_map_base,
        np.array(trail, dtype=np.float64).reshape(-1, 2),
        goal.pose if isinstance(goal, Waypoint) else None,
        "bright_cyan",
    )
    rows, cols = robot.grid.shape
    tall = min(max(round(columns * rows / max(cols, 1) / 2), 8), _TALLEST_MAP)
    lines = MapDots(columns, tall).lines(robot.grid, [mark])
    return [line for line in lines if line.plain.strip()]

"""The recording of one robot: writes what has changed, and nothing else."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

from explore_bt.interfaces import HeldBy, MateFrame, NodeState, RobotSnapshot
from explore_bt.recording.drawing import drawing_message
from explore_bt.recording.foxglove import (
    grid_message,
    path_message,
    pose_message,
    quote,
    scan_message,
    stamp_ns,
    time_json,
)
from explore_bt.recording.measurements import measurements_message
from explore_bt.recording.moving import moving_message
from explore_bt.recording.tree_tally import NodeTally, TreeTally
from explore_bt.recording.values import to_json
from explore_bt.types import (
    Doing,
    Drawing,
    Health,
    Imu,
    Measurement,
    MovingObstacle,
    OccupancyGrid,
    Path,
    PointCloud,
    Pose2,
    Scan2D,
    Score,
    Waypoint,
    WheelOdometry,
)

__all__ = ["Periods", "RobotTrack"]

_encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode
_CELLS_PER_SECOND = 40_000  # of map, so that a large building cannot fill the disk
_SECOND_NS = 1_000_000_000
_COUNT_PERIOD_NS = 10 * _SECOND_NS
_SCORES = tuple(each.name for each in fields(Score))
_NOTHING = object()


@dataclass(frozen=True, slots=True)
class Periods:
    """Shortest time between two messages of a kind, nanoseconds of mission time."""

    key_frame: int
    scan: int
    map: int
    path: int = _SECOND_NS // 2
    state: int = _SECOND_NS // 2
    moving: int = _SECOND_NS // 4


class _Throttle:
    def __init__(self, period_ns: int) -> None:
        self._period_ns = period_ns
        self._next_ns = -(2**62)

    def ready(self, time_ns: int) -> bool:
        return time_ns >= self._next_ns

    def passed(self, time_ns: int, rest_ns: int = 0) -> None:
        self._next_ns = time_ns + max(self._period_ns, rest_ns)


class RobotTrack:
    """Remembers what was last written about a robot, and writes the differences.

    Args:
        robot: its name, the first part of its topics.
        write: takes topic, mission time in ns and the message.
        clouds: whether 3D lidars are recorded.
    """

    def __init__(
        self, robot: str, write: Callable[[str, int, str], None], periods: Periods, *, clouds: bool
    ) -> None:
        self._topic = f"/{robot}/"
        self._write = write
        self._kinds = (Scan2D, Imu, WheelOdometry, *((PointCloud,) if clouds else ()))
        self._measured: list[Measurement] = []
        self._nodes: tuple[NodeState, ...] = ()
        self._values: dict[str, object] = {}
        self._texts: dict[str, str] = {}
        self._visited: tuple[object, ...] = ()
        self._goal: object = None
        self._pose: Pose2 | None = None
        self._health: tuple[Health, str] | None = None
        self._scan: Scan2D | None = None
        self._grid: OccupancyGrid | None = None
        self._grid_written: OccupancyGrid | None = None
        self._path: object = _NOTHING
        self._gate_reason = ""
        self._told: object = (Doing.AT_WORK, (), ())
        self._drawing = Drawing()
        self._moving_told: tuple[MovingObstacle, ...] = ()
        self._tally, self._count_due = TreeTally(), _Throttle(_COUNT_PERIOD_NS)
        self._tree_due, self._board_due = _Throttle(periods.key_frame), _Throttle(periods.key_frame)
        self._scan_due, self._map_due = _Throttle(periods.scan), _Throttle(periods.map)
        self._path_due, self._state_due = _Throttle(periods.path), _Throttle(periods.state)
        self._pose_due, self._moving_due = _Throttle(_SECOND_NS), _Throttle(periods.moving)

    def on_tick(self, time_ns: int, tick: int, robot: RobotSnapshot) -> None:
        """Write what this tick has changed."""
        self._tree(time_ns, tick, robot.nodes)
        self._count(time_ns, robot.nodes)
        self._blackboard(time_ns, robot.blackboard)
        self._waypoints(time_ns, robot.blackboard)
        self._poses(time_ns, robot)
        self._sensing(time_ns, robot)
        self._plan(time_ns, robot.path)
        self._gate(time_ns, robot)
        self._team(time_ns, robot)
        self._moving(time_ns, robot.moving)
        self._draw(time_ns, robot.drawing)
        self._measured += [each for each in robot.measured if isinstance(each, self._kinds)]

    def write_measurements(self, time_ns: int) -> None:
        """Write what was measured since the last time."""
        if self._measured:
            self._write(self._topic + "measured", time_ns, measurements_message(time_ns, self._measured))
            self._measured = []

    def close(self, time_ns: int) -> None:
        """Write what was held back: the last counts, the last measurements, the last map."""
        self._write_counts(time_ns)
        self.write_measurements(time_ns)
        self._map(time_ns)

    def _tree(self, time_ns: int, tick: int, nodes: tuple[NodeState, ...]) -> None:
        key_frame = self._tree_due.ready(time_ns) or len(nodes) != len(self._nodes)
        changed = [
            (index, node)
            for index, node in enumerate(nodes)
            if key_frame
            # not ``node !=``: a dataclass makes two tuples to compare, for every node at every tick
            or node.status != self._nodes[index].status
            or node.message != self._nodes[index].message
        ]
        self._nodes = nodes
        if key_frame:
            self._tree_due.passed(time_ns)
        elif not changed:
            return
        states = ",".join(
            f'{{"id":{index},"status":{quote(node.status)},"message":{quote(node.message)}}}'
            for index, node in changed
        )
        head = f'{{"timestamp":{time_json(time_ns)},"tick":{tick},"key_frame":{_flag(key_frame)}'
        self._write(self._topic + "tree", time_ns, f'{head},"nodes":[{states}]}}')

    def _count(self, time_ns: int, nodes: tuple[NodeState, ...]) -> None:
        self._tally.on_tick(time_ns / _SECOND_NS, nodes)
        if self._count_due.ready(time_ns):
            self._count_due.passed(time_ns)
            self._write_counts(time_ns)

    def _write_counts(self, time_ns: int) -> None:
        if self._tally.nodes:
            counts = ",".join(_tally(index, node) for index, node in enumerate(self._tally.nodes))
            text = f'{{"timestamp":{time_json(time_ns)},"nodes":[{counts}]}}'
            self._write(self._topic + "nodes", time_ns, text)

    def _blackboard(self, time_ns: int, board: Mapping[str, object]) -> None:
        differences: dict[str, str] = {}
        for key, value in board.items():
            if self._values.get(key, _NOTHING) is value:
                continue
            self._values[key] = value
            text = _encode(to_json(value))
            if self._texts.get(key) != text:
                differences[key] = self._texts[key] = text
        removed = [key for key in self._values if key not in board] if len(board) < len(self._values) else []
        for key in removed:
            del self._values[key], self._texts[key]
        key_frame = self._board_due.ready(time_ns)
        if key_frame:
            self._board_due.passed(time_ns)
            differences = self._texts
        elif not differences and not removed:
            return
        entries = ",".join(f"{quote(key)}:{text}" for key, text in differences.items())
        head = f'{{"timestamp":{time_json(time_ns)},"key_frame":{_flag(key_frame)}'
        self._write(
            self._topic + "blackboard", time_ns, f'{head},"set":{{{entries}}},"removed":{_encode(removed)}}}'
        )

    def _waypoints(self, time_ns: int, board: Mapping[str, object]) -> None:
        goal, visited = board.get("goal"), board.get("visited")
        if isinstance(goal, Waypoint) and goal is not self._goal and goal != self._goal:
            self._waypoint("waypoint", time_ns, goal)
        self._goal = goal
        if not isinstance(visited, tuple) or visited is self._visited:
            return
        known = len(self._visited)
        begin = known if visited[:known] == self._visited else 0
        for index, waypoint in enumerate(visited[begin:], begin):
            if isinstance(waypoint, Waypoint):
                self._waypoint("visited", time_ns, waypoint, f',"index":{index}')
        self._visited = visited

    def _waypoint(self, topic: str, time_ns: int, waypoint: Waypoint, extra: str = "") -> None:
        gain = _encode(to_json(waypoint.expected_gain_m2))
        words = f',"reason":{quote(waypoint.reason)},"expected_gain_m2":{gain}{extra}'
        self._write(self._topic + topic, time_ns, pose_message(time_ns, waypoint.pose, words))

    def _poses(self, time_ns: int, robot: RobotSnapshot) -> None:
        pose = robot.estimate.T_map_base
        if pose != self._pose or self._pose_due.ready(time_ns):
            self._pose = pose
            self._pose_due.passed(time_ns)
            self._write(self._topic + "pose", time_ns, pose_message(time_ns, pose))
            if robot.true_pose is not None:
                self._write(self._topic + "truth", time_ns, pose_message(time_ns, robot.true_pose))
        health = (robot.estimate.health, robot.estimate.reason)
        if health != self._health or self._state_due.ready(time_ns):
            self._health = health
            self._state_due.passed(time_ns)
            self._write(self._topic + "state", time_ns, _state(time_ns, robot))

    def _sensing(self, time_ns: int, robot: RobotSnapshot) -> None:
        if robot.scan is not None and robot.scan is not self._scan and self._scan_due.ready(time_ns):
            self._scan = robot.scan
            self._scan_due.passed(time_ns)
            at_ns = stamp_ns(robot.scan.stamp_s) if math.isfinite(robot.scan.stamp_s) else time_ns
            straight = robot.scan.straightened(robot.scan_twist)
            text = scan_message(max(at_ns, 0), straight, robot.seen_from)
            self._write(self._topic + "scan", time_ns, text)
        self._grid = robot.grid
        if self._map_due.ready(time_ns):
            self._map(time_ns)

    def _map(self, time_ns: int) -> None:
        old, new = self._grid_written, self._grid
        if new is None or new is old or (old and (old.revision, old.shape) == (new.revision, new.shape)):
            return
        self._grid_written = new
        text = grid_message(time_ns, new)
        if text is not None:
            self._map_due.passed(time_ns, new.cells.size * _SECOND_NS // _CELLS_PER_SECOND)
            self._write(self._topic + "map", time_ns, text)

    def _plan(self, time_ns: int, path: Path | None) -> None:
        if path is not self._path and self._path_due.ready(time_ns):
            self._path = path
            self._path_due.passed(time_ns)
            self._write(self._topic + "path", time_ns, path_message(time_ns, path))

    def _gate(self, time_ns: int, robot: RobotSnapshot) -> None:
        reason = robot.gate_reason
        if reason != self._gate_reason:
            self._gate_reason = reason
            head = f'{{"timestamp":{time_json(time_ns)},"braking":{_flag(bool(reason))}'
            held_by = quote(robot.held_by if reason else HeldBy.NOTHING)
            self._write(
                self._topic + "gate", time_ns, f'{head},"reason":{quote(reason)},"held_by":{held_by}}}'
            )

    def _team(self, time_ns: int, robot: RobotSnapshot) -> None:
        told = (robot.doing, robot.claims, robot.mates)
        if told != self._told:
            self._told = told
            mates = [_mate(mate) for mate in robot.mates]
            words = _encode(to_json({"doing": robot.doing, "claims": robot.claims, "mates": mates}))
            self._write(self._topic + "team", time_ns, f'{{"timestamp":{time_json(time_ns)},{words[1:]}')

    def _moving(self, time_ns: int, moving: tuple[MovingObstacle, ...]) -> None:
        if moving != self._moving_told and self._moving_due.ready(time_ns):
            self._moving_told = moving
            self._moving_due.passed(time_ns)
            self._write(self._topic + "moving", time_ns, moving_message(time_ns, moving))

    def _draw(self, time_ns: int, drawing: Drawing) -> None:
        if drawing is not self._drawing and drawing != self._drawing:
            self._write(self._topic + "drawing", time_ns, drawing_message(time_ns, drawing))
        self._drawing = drawing


def _flag(value: bool) -> str:
    return "true" if value else "false"


def _tally(index: int, node: NodeTally) -> str:
    return (
        f'{{"id":{index},"ticks":{node.ticks},"successes":{node.successes},"failures":{node.failures},'
        f'"cut_off":{node.cut_off},"running_s":{node.running_s:.3f},"longest_s":{node.longest_s:.3f}}}'
    )


def _state(time_ns: int, robot: RobotSnapshot) -> str:
    figures = {
        "speed_mps": robot.motion.twist.linear_mps,
        "turn_rate_rps": robot.motion.twist.angular_rps,
        "health": robot.estimate.health,
        "health_reason": robot.estimate.reason,
        "held_by": robot.held_by if robot.gate_reason else HeldBy.NOTHING,
        "moving": len(robot.moving),
        "charge": robot.charge,
        "left": {budget.name: budget.left for budget in robot.budgets},
        **{name: getattr(robot.score, name) for name in _SCORES},
    }
    return f'{{"timestamp":{time_json(time_ns)},{_encode(to_json(figures))[1:]}'


def _mate(mate: MateFrame) -> dict[str, object]:
    T = mate.T_ours_theirs
    place = None if T is None else {"x": T.x, "y": T.y, "yaw": T.yaw_rad}
    return {"name": mate.name, "T_ours_theirs": place, "not_merged": mate.not_merged}

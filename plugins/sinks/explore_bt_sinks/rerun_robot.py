"""One robot in Rerun."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
import rerun
from numpy.typing import NDArray

from explore_bt.interfaces import NodeInfo, NodeState, RobotSnapshot
from explore_bt.types import Drawing, OccupancyGrid, Path, Pose2, SectorMark, Verdict, ViewMark

__all__ = ["RerunRobot"]

_ROBOT, _SCAN, _PATH, _PERSON = (47, 111, 237), (215, 38, 61), (15, 157, 118), (180, 72, 155)
_VERDICTS = {Verdict.TAKEN: (15, 157, 118), Verdict.REJECTED: (215, 38, 61), Verdict.OPEN: (138, 148, 160)}
_UNKNOWN, _FREE, _WALL = (205, 211, 217, 255), (255, 255, 255, 255), (43, 53, 66, 255)
_MARKS = {"running": "▶", "success": "✔", "failure": "✘", "idle": "·"}
_ARC = 12
_FIGURES_PERIOD_S = 0.5


class Settings(Protocol):
    """How often things are shown."""

    map_period: float
    scan_period: float


class RerunRobot:
    """Logs what has changed below the robot's name; places are metres in the ``map`` frame, z = 0."""

    def __init__(
        self,
        stream: rerun.RecordingStream,
        name: str,
        nodes: tuple[NodeInfo, ...],
        radius_m: float,
        settings: Settings,
    ) -> None:
        self._stream = stream
        self._name = name
        self._infos = nodes
        self._radius_m = radius_m
        self._settings = settings
        self._grid: OccupancyGrid | None = None
        self._path: Path | None = None
        self._drawing = Drawing()
        self._nodes: tuple[NodeState, ...] = ()
        self._due_s = dict.fromkeys(("map", "scan", "figures"), -math.inf)

    def show(self, stamp_s: float, robot: RobotSnapshot) -> None:
        """Log a tick's news; the stream's time is set already."""
        self._show_pose(robot.estimate.T_map_base, bool(robot.gate_reason))
        if robot.grid is not self._grid and self._is_due("map", stamp_s, self._settings.map_period):
            self._grid = robot.grid
            self._log("map", _grid_map(robot.grid))
        if robot.scan is not None and self._is_due("scan", stamp_s, self._settings.scan_period):
            points = robot.seen_from.apply(robot.scan.straightened(robot.scan_twist).points())
            self._log("scan", rerun.Points3D(_flat(points), radii=0.02, colors=_SCAN))
        if robot.path is not self._path:
            self._path = robot.path
            places = np.empty((0, 2)) if robot.path is None else robot.path.poses[:, :2]
            self._log("path", rerun.LineStrips3D([_flat(places)], radii=0.02, colors=_PATH))
        if robot.drawing is not self._drawing:
            self._drawing = robot.drawing
            self._show_drawing(robot.drawing)
        if robot.nodes != self._nodes:
            self._nodes = robot.nodes
            self._log("tree", rerun.TextDocument(self._tree_text(robot.nodes)))
        places = np.array([thing.xy for thing in robot.moving]).reshape(-1, 2)
        self._log("moving", rerun.Points3D(_flat(places), radii=0.25, colors=_PERSON))
        if self._is_due("figures", stamp_s, _FIGURES_PERIOD_S):
            self._show_figures(robot)

    def _is_due(self, what: str, stamp_s: float, period_s: float) -> bool:
        if stamp_s < self._due_s[what]:
            return False
        self._due_s[what] = stamp_s + period_s
        return True

    def _log(self, what: str, shown: rerun.AsComponents) -> None:
        self._stream.log(f"{self._name}/{what}", shown)

    def _show_pose(self, pose: Pose2, is_held: bool) -> None:
        nose = self._radius_m * 1.6 * np.array((math.cos(pose.yaw_rad), math.sin(pose.yaw_rad), 0.0))
        colour = _SCAN if is_held else _ROBOT
        here = [(pose.x, pose.y, 0.0)]
        self._log("pose", rerun.Points3D(here, radii=self._radius_m, colors=colour))
        self._log("heading", rerun.Arrows3D(vectors=[nose], origins=here, radii=0.03, colors=colour))

    def _show_drawing(self, drawing: Drawing) -> None:
        sectors, views = drawing.sectors or (), drawing.views or ()
        self._log(
            "sectors",
            rerun.LineStrips3D(
                [_wedge(sector) for sector in sectors],
                colors=[_VERDICTS[sector.state] for sector in sectors],
                labels=[_label(sector) for sector in sectors],
            ),
        )
        self._log(
            "views",
            rerun.Points3D(
                [(view.x, view.y, 0.0) for view in views],
                radii=0.1,
                colors=[_VERDICTS[view.state] for view in views],
                labels=[_label(view) for view in views],
            ),
        )

    def _tree_text(self, nodes: tuple[NodeState, ...]) -> str:
        """The tree as a text: a mark, the name, the words."""
        lines = (
            f"{'  ' * info.path.count('/')}{_MARKS[state.status]} {info.name}  {state.message}".rstrip()
            for info, state in zip(self._infos, nodes, strict=True)
        )
        return "\n".join(lines)

    def _show_figures(self, robot: RobotSnapshot) -> None:
        figures = {
            "coverage": robot.score.coverage,
            "distance_m": robot.score.distance_m,
            "speed_mps": robot.motion.twist.linear_mps,
            "charge": robot.charge,
        }
        for name, figure in figures.items():
            if figure is not None:
                self._log(f"figures/{name}", rerun.Scalars(figure))


def _flat(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 2) on the floor: (N, 3)."""
    return np.column_stack((points, np.zeros(len(points))))


def _label(mark: SectorMark | ViewMark) -> str:
    return f"{mark.state}: {mark.reason}" if mark.reason else str(mark.state)


def _wedge(sector: SectorMark) -> NDArray[np.float64]:
    angles = np.linspace(sector.from_rad, sector.to_rad, _ARC)
    arc = sector.range_m * np.column_stack((np.cos(angles), np.sin(angles)))
    return _flat(np.vstack(((0.0, 0.0), arc, (0.0, 0.0))) + np.array((sector.x, sector.y)))


def _grid_map(grid: OccupancyGrid) -> rerun.GridMap:
    """Rerun's first row is the upper one."""
    rows, cols = grid.shape
    pixels = np.full((rows, cols, 4), _UNKNOWN, dtype=np.uint8)
    pixels[grid.free], pixels[grid.occupied] = _FREE, _WALL
    return rerun.GridMap(
        data=pixels[::-1].tobytes(),
        format=rerun.components.ImageFormat(
            width=cols, height=rows, color_model="RGBA", channel_datatype="U8"
        ),
        cell_size=grid.resolution_m,
        translation=[*grid.origin_xy, -0.01],
    )

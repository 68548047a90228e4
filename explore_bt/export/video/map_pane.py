"""The map with all that is on it."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.export.video.canvas import Canvas, rgb
from explore_bt.export.video.scene import RobotScene, Scene
from explore_bt.report.overlay import cropped, overlaid
from explore_bt.report.palette import robot_colour
from explore_bt.types import OccupancyGrid

__all__ = ["MapPane"]

UNKNOWN, FREE, WALL = rgb("#e9edf1"), rgb("#ffffff"), rgb("#2b3542")
_SCAN, _PATH, _PERSON = rgb("#d7263d"), rgb("#0f9d76"), rgb("#b4489b")
_VERDICTS = {"taken": rgb("#0f9d76"), "rejected": rgb("#d7263d"), "open": rgb("#8a94a0")}
_ARC = 12
_HALF_PLANE_M = 1.5


class MapPane:
    """Draws into a box of a canvas, so that the whole of a map of known extent fits.

    Args:
        box: x, y, width, height in pixels.
        extent: x and y of the lower left and of the upper right corner, metres.
        radius_m: footprint radius by robot.
    """

    def __init__(
        self,
        box: tuple[int, int, int, int],
        extent: tuple[float, float, float, float],
        radius_m: dict[str, float],
    ) -> None:
        left, top, width, height = box
        x0, y0, x1, y1 = extent
        self.scale = min(width / (x1 - x0), height / (y1 - y0))
        self._corner = (
            left + 0.5 * (width - self.scale * (x1 - x0)) - self.scale * x0,
            top + 0.5 * (height + self.scale * (y1 - y0)) + self.scale * y0,
        )
        self._box = box
        self._radius_m = radius_m
        self._grids: tuple[OccupancyGrid, ...] = ()
        self._picture = np.empty((0, 0, 3), dtype=np.uint8)

    def pixels_of(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(..., 2) metres as pixels."""
        return np.asarray(points) * (self.scale, -self.scale) + self._corner

    def draw(self, canvas: Canvas, scene: Scene) -> None:
        """The moment's map, what the leaves saw, scans, ways and robots, from below to above."""
        self._draw_grid(canvas, scene)
        for name, robot in scene.robots.items():
            self._draw_layers(canvas, robot.layers, self._radius_m.get(name, 0.25))
        for index, robot in enumerate(scene.robots.values()):
            canvas.dots(self.pixels_of(robot.scan), _SCAN)
            trail = np.array(robot.trail).reshape(-1, 2)
            canvas.line(self.pixels_of(trail), rgb(robot_colour(index)), 2)
            canvas.line(self.pixels_of(robot.path), _PATH, 2)
        for index, (name, robot) in enumerate(scene.robots.items()):
            self._draw_moving(canvas, robot)
            self._draw_robot(canvas, robot, self._radius_m.get(name, 0.25), rgb(robot_colour(index)))

    def _draw_grid(self, canvas: Canvas, scene: Scene) -> None:
        grids = tuple(robot.grid for robot in scene.robots.values() if robot.grid is not None)
        if grids != self._grids:
            self._grids, self._picture = grids, self._painted(grids)
        left, top, width, height = self._box
        canvas.fill(self._box, UNKNOWN)
        if self._picture.size:
            canvas.pixels[top : top + height, left : left + width] = self._picture

    def _painted(self, grids: tuple[OccupancyGrid, ...]) -> NDArray[np.uint8]:
        """(height, width, 3) the maps in one, brought to the size of the box."""
        left, top, width, height = self._box
        if not grids:
            return np.empty((0, 0, 3), dtype=np.uint8)
        grid = cropped(overlaid(grids))
        cells = np.full((*grid.shape, 3), UNKNOWN, dtype=np.uint8)
        cells[grid.free], cells[grid.occupied] = FREE, WALL
        size = grid.resolution_m
        x, y = self.pixels_of(np.array(grid.origin_xy)) - (left, top)
        # column c of the grid begins at pixel x + c * scale * size, row r at y - r * scale * size
        step = self.scale * size
        matrix = np.array([[step, 0.0, x + 0.5 * step - 0.5], [0.0, -step, y - 0.5 * step - 0.5]])
        picture = cv2.warpAffine(cells, matrix, (width, height), flags=cv2.INTER_NEAREST, borderValue=UNKNOWN)
        return np.asarray(picture, dtype=np.uint8)

    def _draw_layers(self, canvas: Canvas, layers: dict[str, list[dict[str, Any]]], radius_m: float) -> None:
        for sector in layers.get("sectors", ()):
            canvas.area(self._wedge(sector), _VERDICTS[sector["state"]], 0.35)
        for plane in layers.get("half_planes", ())[:1]:
            canvas.line(self._edge(plane), _VERDICTS["open"], 2)
        for frontier in layers.get("frontiers", ()):
            place = self.pixels_of(np.array((frontier["x"], frontier["y"])))
            canvas.dot(place.tolist(), 4.0, _VERDICTS[frontier["state"]])
        for view in layers.get("views", ()):
            place = self.pixels_of(np.array((view["x"], view["y"])))
            canvas.dot(place.tolist(), 0.5 * radius_m * self.scale, _VERDICTS[view["state"]], 2)

    def _wedge(self, sector: dict[str, Any]) -> NDArray[np.float64]:
        angles = np.linspace(sector["from_rad"], sector["to_rad"], _ARC)
        arc = sector["range_m"] * np.column_stack((np.cos(angles), np.sin(angles)))
        return self.pixels_of(np.vstack(((0.0, 0.0), arc)) + np.array((sector["x"], sector["y"])))

    def _edge(self, plane: dict[str, Any]) -> NDArray[np.float64]:
        along = np.array((-plane["normal_y"], plane["normal_x"]))
        ends = np.outer((-_HALF_PLANE_M, _HALF_PLANE_M), along)
        return self.pixels_of(ends + np.array((plane["x"], plane["y"])))

    def _draw_moving(self, canvas: Canvas, robot: RobotScene) -> None:
        for thing in robot.moving:
            place = self.pixels_of(np.array((thing["x"], thing["y"])))
            canvas.dot(place.tolist(), max(thing["radius_m"], 0.1) * self.scale, _PERSON, 2)

    def _draw_robot(
        self, canvas: Canvas, robot: RobotScene, radius_m: float, colour: tuple[int, int, int]
    ) -> None:
        pose = robot.pose
        if pose is None or not math.isfinite(pose.x):
            return
        here = self.pixels_of(np.array(pose.xy))
        canvas.dot(here.tolist(), radius_m * self.scale, colour)
        if robot.held:
            canvas.dot(here.tolist(), radius_m * self.scale + 2.0, _SCAN, 2)
        nose = np.array(pose.xy) + radius_m * np.array((math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)))
        canvas.line(np.vstack((here, self.pixels_of(nose))), FREE, 2)

"""A recording frame by frame."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.export.video.canvas import Canvas, rgb
from explore_bt.export.video.map_pane import MapPane
from explore_bt.export.video.scene import Scene
from explore_bt.export.video.timeline import Timeline, TimelinePane
from explore_bt.export.video.tree_pane import TreePane
from explore_bt.recording import Recording, decode_grid
from explore_bt.types import OccupancyGrid

__all__ = ["HEIGHT", "WIDTH", "film", "frame_count"]

WIDTH, HEIGHT = 1280, 720
_MAP_WIDTH, _STRIP = 740, 120
_MARGIN_M = 0.4
_PAPER = rgb("#ffffff")
_TOPICS = ("pose", "tree", "map", "scan", "path", "drawing", "moving", "gate", "state")


def frame_count(recording: Recording, step_s: float) -> int:
    """How many frames a film of a recording has; the last shows its end."""
    return math.ceil(recording.duration_s / step_s - 1e-9) + 1


def film(recording: Recording, step_s: float) -> Iterator[NDArray[np.uint8]]:
    """A frame every ``step_s`` of mission time, each (720, 1280, 3) uint8 RGB.

    What a frame shows depends on the recording only: the same one gives the same pixels.
    """
    trees = recording.info["trees"]
    robots = [f"/{robot}/{topic}" for robot in trees for topic in _TOPICS]
    scene, messages = Scene(trees), recording.messages({"/events", *robots})
    panes = _panes(recording)
    message = next(messages, None)
    for index in range(frame_count(recording, step_s)):
        stamp_s = min(index * step_s, recording.duration_s)
        while message is not None and message.stamp_s <= stamp_s + 1e-9:
            scene.take(message)
            message = next(messages, None)
        canvas = Canvas(WIDTH, HEIGHT, _PAPER)
        map_pane, tree_pane, timeline = panes
        map_pane.draw(canvas, scene)
        canvas.fill((_MAP_WIDTH, 0, WIDTH - _MAP_WIDTH, HEIGHT), _PAPER)  # what the map let run over
        tree_pane.draw(canvas, scene)
        timeline.draw(canvas, scene, stamp_s)
        yield canvas.finished()


def _panes(recording: Recording) -> tuple[MapPane, TreePane, TimelinePane]:
    radius_m: dict[str, float] = recording.info.get("footprint_radius_m", {})
    top = HEIGHT - _STRIP
    return (
        MapPane((0, 0, _MAP_WIDTH, top), _extent(recording), radius_m),
        TreePane((_MAP_WIDTH, 0, WIDTH - _MAP_WIDTH, top)),
        TimelinePane((0, top, WIDTH, _STRIP), _timeline(recording)),
    )


def _extent(recording: Recording) -> tuple[float, float, float, float]:
    """What all maps of the run cover, so that the picture never jumps."""
    corners = [
        _corners(decode_grid(message.value))
        for message in recording.messages({f"/{robot}/map" for robot in recording.robots})
    ]
    if not corners:
        return (-5.0, -5.0, 5.0, 5.0)
    low, high = np.min(corners, axis=0)[:2], np.max(corners, axis=0)[2:]
    (x0, y0), (x1, y1) = (low - _MARGIN_M).tolist(), (high + _MARGIN_M).tolist()
    return (x0, y0, x1, y1)


def _corners(grid: OccupancyGrid) -> tuple[float, float, float, float]:
    (x, y), (rows, cols), size = grid.origin_xy, grid.shape, grid.resolution_m
    return (x, y, x + cols * size, y + rows * size)


def _timeline(recording: Recording) -> Timeline:
    first = recording.robots[0] if recording.robots else ""
    rows = [
        (message.stamp_s, _known(message.value, "coverage"), _known(message.value, "speed_mps"))
        for message in recording.messages(f"/{first}/state")
    ]
    told = recording.messages("/events")
    events = [(each.stamp_s, int(each.value["level"])) for each in told if each.value["level"] > 2]
    return Timeline(recording.duration_s, np.array(rows, dtype=np.float64).reshape(-1, 3), events)


def _known(value: dict[str, Any], name: str) -> float:
    figure = value.get(name)
    return math.nan if figure is None else float(figure)

"""The picture of a run: map, driven path, waypoints with headings."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.report.history import Track, clearance_range_m
from explore_bt.report.palette import CLEARANCE_STOPS, robot_colour
from explore_bt.report.run_history import RunHistory
from explore_bt.report.words import duration, length, percent
from explore_bt.types import OccupancyGrid, Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["map_view_png"]

_UNKNOWN, _FREE, _WALL, _INK, _SOFT = "#e9edf1", "#ffffff", "#2b3542", "#16202c", "#5d6b7a"
_WIDTH_IN, _DPI = 8.0, 150


def map_view_png(history: RunHistory, result: Result) -> bytes | None:
    """A PNG of about 1200 pixels in width; None if no map was ever seen."""
    # imported here: it takes half a second, and most commands never draw
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    grid = history.map()
    if grid is None:
        return None
    rows, cols = grid.shape
    map_height_in = min(max((_WIDTH_IN - 0.4) * rows / cols, 2.0), 12.0)
    figure = Figure(figsize=(_WIDTH_IN, map_height_in + 1.35), dpi=_DPI, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    height_in = map_height_in + 1.35
    axes = figure.add_axes((0.025, 0.75 / height_in, 0.95, map_height_in / height_in))
    _draw_map(axes, grid)
    tracks = [robot.track() for robot in history.robots.values()]
    coloured = len(tracks) == 1
    span = clearance_range_m(tracks, min(robot.footprint_radius_m for robot in history.robots.values()))
    for index, (robot, track) in enumerate(zip(history.robots.values(), tracks, strict=True)):
        lines = _draw_path(axes, track, span if coloured else None, robot_colour(index))
        poses = np.array([one.waypoint.pose.as_array() for one in robot.waypoints]).reshape(-1, 3)
        _draw_waypoints(axes, poses, _INK if coloured else robot_colour(index))
        _draw_ends(axes, track, robot.footprint_radius_m, robot_colour(index))
        if coloured and lines is not None:
            _draw_key(figure, lines, height_in)
    _draw_scale(axes, grid)
    _draw_words(figure, history, result, height_in, coloured)
    with io.BytesIO() as file:
        canvas.print_png(file)  # type: ignore[no-untyped-call]  # matplotlib leaves it untyped
        return file.getvalue()


def _draw_map(axes: Axes, grid: OccupancyGrid) -> None:
    from matplotlib.colors import to_rgb

    picture = np.empty((*grid.shape, 3))
    picture[:] = to_rgb(_UNKNOWN)
    picture[grid.free] = to_rgb(_FREE)
    picture[grid.occupied] = to_rgb(_WALL)
    (x, y), (rows, cols), size = grid.origin_xy, grid.shape, grid.resolution_m
    extent = (x, x + cols * size, y, y + rows * size)
    axes.imshow(picture, origin="lower", extent=extent, interpolation="nearest")
    axes.set_axis_off()


def _draw_path(axes: Axes, track: Track, span: tuple[float, float] | None, colour: str) -> Any:
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap

    if len(track.poses) < 2:
        return None
    thin = track.thinned(4000)
    points = thin.poses[:, :2]
    segments = np.stack((points[:-1], points[1:]), axis=1)
    lines = LineCollection(list(segments), linewidths=2.4, capstyle="round", zorder=3)
    if span is None:
        lines.set_color(colour)
    else:
        lines.set_cmap(LinearSegmentedColormap.from_list("clearance", CLEARANCE_STOPS))
        lines.set_array(np.nan_to_num(thin.clearance_m[1:], nan=span[0]))
        lines.set_clim(*span)
    axes.add_collection(lines, autolim=False)
    return lines


def _draw_waypoints(axes: Axes, poses: NDArray[np.float64], colour: str) -> None:
    if not len(poses):
        return
    size_m = 0.30
    dx, dy = size_m * np.cos(poses[:, 2]), size_m * np.sin(poses[:, 2])
    axes.quiver(
        poses[:, 0],
        poses[:, 1],
        dx,
        dy,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.0042,
        headwidth=4.2,
        headlength=4.6,
        color=colour,
        edgecolor="white",
        linewidth=0.7,
        zorder=4,
    )
    axes.scatter(poses[:, 0], poses[:, 1], s=13, color=colour, edgecolors="white", linewidths=0.7, zorder=5)


def _draw_ends(axes: Axes, track: Track, radius_m: float, colour: str) -> None:
    from matplotlib.patches import Circle

    if not len(track.poses):
        return
    x, y, yaw = track.poses[-1].tolist()
    axes.add_patch(
        Circle((x, y), radius_m, facecolor=colour, edgecolor="white", linewidth=1.6, alpha=0.9, zorder=6)
    )
    tip = (x + radius_m * np.cos(yaw), y + radius_m * np.sin(yaw))
    axes.plot((x, tip[0]), (y, tip[1]), color="white", linewidth=1.8, zorder=7)
    x0, y0 = track.poses[0, :2].tolist()
    ring = Circle(
        (x0, y0),
        radius_m * 1.35,
        fill=False,
        edgecolor=colour,
        linewidth=1.4,
        linestyle=(0, (3, 2)),
        zorder=6,
    )
    axes.add_patch(ring)


def _draw_scale(axes: Axes, grid: OccupancyGrid) -> None:
    metres = max(1.0, round(grid.shape[1] * grid.resolution_m / 8.0))
    share = metres / (grid.shape[1] * grid.resolution_m)
    box = axes.transAxes
    axes.plot((0.0, share), (-0.022, -0.022), color=_SOFT, linewidth=2.2, transform=box, clip_on=False)
    axes.text(share + 0.01, -0.022, f"{metres:g} m", color=_SOFT, fontsize=8.5, va="center", transform=box)


def _draw_key(figure: Figure, lines: Any, height_in: float) -> None:
    place = figure.add_axes((0.70, 0.40 / height_in, 0.265, 0.085 / height_in))
    bar = figure.colorbar(lines, cax=place, orientation="horizontal")
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, colors=_SOFT, length=2)
    bar.set_label("clearance along the path, m", fontsize=8, color=_SOFT, labelpad=1)


def _draw_words(
    figure: Figure, history: RunHistory, result: Result, height_in: float, coloured: bool
) -> None:
    top = 1.0 - 0.30 / height_in
    figure.text(
        0.025,
        top,
        history.run.mission,
        fontsize=13,
        fontweight="bold",
        color=_INK,
        va="center",
        parse_math=False,
    )
    facts = [f"{percent(result.coverage)} mapped"] if result.coverage is not None else []
    facts += [f"{length(result.path_length_m)} driven", duration(result.mission_time_s)]
    facts += [f"{result.contacts} contacts"] if result.contacts is not None else []
    figure.text(0.975, top, "  ·  ".join(facts), fontsize=9.5, color=_SOFT, va="center", ha="right")
    if not coloured:
        names = [(name, robot_colour(index)) for index, name in enumerate(history.robots)]
        for k, (name, colour) in enumerate(names[:6]):
            figure.text(
                0.30 + 0.11 * k, 0.3 / height_in, f"● {name}", fontsize=9, color=colour, parse_math=False
            )

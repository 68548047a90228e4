"""The report: one file that opens in any browser, without a network."""

from __future__ import annotations

import json
import math
from html import escape
from importlib.resources import files

from explore_bt.report.charts import Series, chart
from explore_bt.report.history import RobotHistory, Track, clearance_range_m
from explore_bt.report.map_picture import cells_png, data_uri, first_seen_png
from explore_bt.report.palette import CLEARANCE_STOPS, robot_colour
from explore_bt.report.run_history import RunHistory
from explore_bt.report.sections import (
    dry_run_note,
    files_section,
    gate_section,
    nodes_section,
    result_section,
    slam_section,
    tiles,
    why_section,
)
from explore_bt.report.what_happened import what_happened_section
from explore_bt.report.words import headline, outcome_words
from explore_bt.types import OccupancyGrid, Result

__all__ = ["report_page"]

_MOST_SAMPLES = 4000  # of a track: about 0.1 MB in the page


def report_page(history: RunHistory, result: Result) -> str:
    """The whole page as HTML text."""
    run, robots = history.run, list(history.robots.values())
    tracks = [robot.track() for robot in robots]
    grid = history.map()
    several = len(robots) > 1
    values = {
        "title": escape(f"{run.mission} – explore-bt"),
        "style": _asset("report.css"),
        "script": _asset("report.js"),
        "data": _data(history, grid, tracks) if grid is not None else "null",
        "mission": escape(run.mission),
        "about": escape(f"seed {run.seed} · explore-bt {run.version}"),
        "outcome": escape(result.outcome.value),
        "outcome_words": escape(outcome_words(result.outcome)),
        "reason": escape(result.reason[:1].upper() + result.reason[1:]),
        "headline": escape(headline(result)),
        "tiles": tiles(result),
        "dry_run": dry_run_note(result),
        "legend": _legend(robots, several),
        "why": why_section(result),
        "files": files_section(run.folder),
        "charts": _charts(robots, tracks, history.end_s),
        "slam": slam_section(result),
        "gate": gate_section(robots) if any(robot.nodes for robot in robots) else "",
        "events": what_happened_section(history),
        "trees": "".join(nodes_section(robot, several) for robot in robots if robot.nodes),
        "result": result_section(result),
    }
    page = _asset("report.html")
    head, *rest = page.split("{{")
    filled = [head]
    for part in rest:  # one pass, so that nothing inside a value is taken for a place to fill
        name, _, text = part.partition("}}")
        filled += [values[name], text]
    return "".join(filled)


def _asset(name: str) -> str:
    return (files("explore_bt.report") / "assets" / name).read_text(encoding="utf-8")


def _legend(robots: list[RobotHistory], several: bool) -> str:
    if not several:
        return ""
    names = (
        f'<li><i style="background:{robot_colour(index)}"></i>{escape(robot.name)}</li>'
        for index, robot in enumerate(robots)
    )
    return f'<ul class="robots">{"".join(names)}</ul>'


def _charts(robots: list[RobotHistory], tracks: list[Track], end_s: float) -> str:
    def lines(column: str, factor: float = 1.0) -> list[Series]:
        return [
            Series(robot.name, robot_colour(index), track.stamps_s, getattr(track, column) * factor)
            for index, (robot, track) in enumerate(zip(robots, tracks, strict=True))
        ]

    return "".join(
        (
            chart("Mapped", "%", lines("coverage", 100.0), end_s, top=100.0),
            chart("Driven", "m", lines("distance_m"), end_s),
            chart("Clearance", "m", lines("clearance_m"), end_s),
            chart("Battery", "%", lines("charge", 100.0), end_s, top=100.0),
        )
    )


def _data(history: RunHistory, grid: OccupancyGrid, tracks: list[Track]) -> str:
    """What the script draws, as JSON that cannot end its script element."""
    robots = list(history.robots.values())
    tight_m, wide_m = clearance_range_m(tracks, min(robot.footprint_radius_m for robot in robots))
    rows, cols = grid.shape
    data = {
        "end_s": round(history.end_s, 2),
        "map": {
            "cells": data_uri(cells_png(grid)),
            "seen": data_uri(first_seen_png(history.first_seen_s(grid), history.end_s)),
            "rows": rows,
            "cols": cols,
            "resolution": grid.resolution_m,
            "origin": list(grid.origin_xy),
        },
        "clearance": {"low": round(tight_m, 3), "high": round(wide_m, 3), "stops": CLEARANCE_STOPS},
        "robots": [
            _robot(index, robot, track)
            for index, (robot, track) in enumerate(zip(robots, tracks, strict=True))
        ],
    }
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def _robot(index: int, robot: RobotHistory, track: Track) -> dict[str, object]:
    thin = track.thinned(_MOST_SAMPLES)
    clearance = [round(value, 3) if math.isfinite(value) else None for value in thin.clearance_m.tolist()]
    return {
        "name": robot.name,
        "colour": robot_colour(index),
        "radius": robot.footprint_radius_m,
        "t": thin.stamps_s.round(2).tolist(),
        "x": thin.poses[:, 0].round(3).tolist(),
        "y": thin.poses[:, 1].round(3).tolist(),
        "yaw": thin.poses[:, 2].round(3).tolist(),
        "clearance": clearance,
        "speed": thin.speed_mps.round(3).tolist(),
        "waypoints": [
            [round(one.stamp_s, 2), *(round(v, 3) for v in one.waypoint.pose.as_array().tolist())]
            for one in robot.waypoints
        ],
    }

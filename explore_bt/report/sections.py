"""The parts of the report's page; every text from outside goes through ``escape``."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

from explore_bt.interfaces import Event, NodeInfo
from explore_bt.report.history import NodeUse, RobotHistory
from explore_bt.report.run_history import RunHistory
from explore_bt.report.words import clock, duration, figure, length, percent
from explore_bt.types import Result

__all__ = [
    "events_section",
    "files_section",
    "gate_section",
    "nodes_section",
    "result_section",
    "slam_section",
    "tiles",
    "why_section",
]

_ABOUT_FILES = {
    "result.json": "every figure, for programs",
    "map.yaml": "map for ROS map_server",
    "map.pgm": "its picture",
    "map_view.png": "map, path and waypoints as a picture",
    "trajectory.tum": "estimated trajectory, TUM format",
    "truth.tum": "true trajectory, TUM format",
    "recording.mcap": "the whole run, opens in Foxglove",
}


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], classes: str = "") -> str:
    """A table of cells that are HTML already."""
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    names = "".join(f"<th>{escape(name)}</th>" for name in head)
    table = f'<table class="{classes}"><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table>'
    return f'<div class="scroll">{table}</div>'


def _section(title: str, content: str, note: str = "") -> str:
    aside = f" <span>{escape(note)}</span>" if note else ""
    return f"<section><h2>{escape(title)}{aside}</h2>{content}</section>"


def tiles(result: Result) -> str:
    """The figures people ask for first."""
    contacts = "–" if result.contacts is None else str(result.contacts)
    touches = result.touched_by_people
    shown = [
        ("mapped", percent(result.coverage), "of the reachable floor"),
        ("driven", length(result.path_length_m), f"in {duration(result.mission_time_s)}"),
        ("contacts", contacts, f"touched by people: {touches}" if touches else "with obstacles"),
        ("closest", length(result.min_clearance_m), f"mean {length(result.mean_clearance_m)}"),
        ("pose error", length(result.ate_rmse_m), "of the trajectory, rmse"),
        ("home", length(result.distance_to_home_m), "from the start"),
    ]
    return "".join(
        f"<div><dt>{label}</dt><dd>{escape(value)}</dd><dd>{escape(note)}</dd></div>"
        for label, value, note in shown
        if value != "–"
    )


def why_section(result: Result) -> str:
    """Why the mission ended, and what is left to explore."""
    left = "".join(f"<li>{escape(line)}</li>" for line in result.left_open)
    rest = f"<h3>Left open</h3><ul>{left}</ul>" if left else "<p>Nothing was left open.</p>"
    return _section("Why it stopped", f"<p>{escape(result.reason) or 'No reason was given.'}</p>{rest}")


def files_section(folder: Path) -> str:
    """Links to what lies beside the report; ``result.json`` is written after it."""
    names = {"result.json"} | {name for name in _ABOUT_FILES if (folder / name).is_file()}
    names |= {str(path.relative_to(folder)) for path in folder.glob("*/*") if path.name in _ABOUT_FILES}
    order = list(_ABOUT_FILES)
    rows = sorted(
        names, key=lambda name: (name.count("/"), name.rpartition("/")[0], order.index(Path(name).name))
    )
    links = "".join(
        f'<li><a href="{quote(name)}">{escape(name)}</a> {escape(_ABOUT_FILES[Path(name).name])}</li>'
        for name in rows
    )
    return _section("Files", f'<ul class="files">{links}</ul>')


def slam_section(result: Result) -> str:
    """The SLAM plugin's own figures."""
    rows = [(escape(name), escape(figure(value))) for name, value in sorted(result.slam.items())]
    return _section("SLAM", _table(("figure", "value"), rows, "figures")) if rows else ""


def gate_section(robots: Iterable[RobotHistory]) -> str:
    """Each time the safety gate braked."""
    found = sorted(
        ((stretch, robot.name) for robot in robots for stretch in robot.interventions),
        key=lambda pair: pair[0].begin_s,
    )
    if not found:
        return _section("Safety gate", "<p>It never had to brake.</p>")
    rows = [
        (clock(one.begin_s), f"{one.end_s - one.begin_s:.1f} s", escape(name), escape(one.reason))
        for one, name in found
    ]
    times = "once" if len(rows) == 1 else f"{len(rows)} times"
    return _section("Safety gate", _table(("at", "for", "robot", "why"), rows, "gate"), f"braked {times}")


def events_section(history: RunHistory) -> str:
    """Everything that was worth a line."""
    if not history.events:
        return _section("Events", "<p>None.</p>")
    levels = history.event_levels()
    note = ", ".join(f"{count} {level}" for level, count in levels.items())
    if history.events_left_out:
        note += f"; {history.events_left_out} more are in the recording"
    return _section("Events", _table(("at", "robot", "from", "what"), map(_event_row, history.events)), note)


def _event_row(event: Event) -> tuple[str, str, str, str]:
    level = event.level if event.level in ("info", "warning", "error") else "info"
    words = f'<span class="level {level}">{level}</span> {escape(event.message)}'
    return (clock(event.stamp_s), escape(event.robot), escape(event.source), words)


def nodes_section(robot: RobotHistory, several: bool) -> str:
    """For each node of a tree, how long it ran and how it ended."""
    rows = [_node_row(node, use) for node, use in zip(robot.nodes, robot.node_uses, strict=False)]
    title = f"Tree of {robot.name}" if several else "Tree"
    head = ("node", "type", "running", "succeeded", "failed", "")
    return _section(title, _table(head, rows, "nodes"), "for how long, how often")


def _node_row(node: NodeInfo, use: NodeUse) -> tuple[str, ...]:
    indent = f"padding-left:{node.path.count('/') * 0.9:.1f}em"
    name = f'<span style="{indent}" title="{escape(node.place, quote=True)}">{escape(node.name)}</span>'
    kind = escape(node.type if node.type != node.name else "")
    running = duration(use.running_s) if use.running_s else "·"
    ends = (f"{count} ×" if count else "·" for count in (use.successes, use.failures))
    return (name, kind, running, *ends, "" if use.was_ticked else "never ticked")


def result_section(result: Result) -> str:
    """Everything that is in ``result.json``."""
    rows = [
        (escape(name), f"<code>{escape(_plain(value))}</code>") for name, value in result.as_dict().items()
    ]
    return _section("result.json", _table(("name", "value"), rows, "figures"))


def _plain(value: object) -> str:
    return str(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False, default=str)

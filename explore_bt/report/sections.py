"""The parts of the report's page; every text from outside goes through ``escape``."""

from __future__ import annotations

import json
from collections.abc import Iterable
from html import escape
from pathlib import Path
from urllib.parse import quote

from explore_bt.files import RECORDING
from explore_bt.interfaces import NodeInfo
from explore_bt.recording import NodeTally
from explore_bt.report.history import RobotHistory
from explore_bt.report.markup import section, table
from explore_bt.report.words import clock, duration, figure, length, percent
from explore_bt.types import Result

__all__ = [
    "dry_run_note",
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
    RECORDING: "the whole run, opens in Foxglove",
}


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


def dry_run_note(result: Result) -> str:
    """A warning above everything else that not all of this was driven; empty for a run that counts."""
    if not result.mocked:
        return ""
    paths = ", ".join(f"<code>{escape(path)}</code>" for path in result.mocked)
    return f'<p class="dry-run"><b>Dry run:</b> scripts played {paths}. Its figures say nothing.</p>'


def why_section(result: Result) -> str:
    """Why the mission ended, and what is left to explore."""
    left = "".join(f"<li>{escape(line)}</li>" for line in result.left_open)
    rest = f"<h3>Left open</h3><ul>{left}</ul>" if left else "<p>Nothing was left open.</p>"
    apart = "".join(f"<li>{escape(line)}</li>" for line in result.not_merged)
    rest += f"<h3>Not merged</h3><ul>{apart}</ul>" if apart else ""
    return section("Why it stopped", f"<p>{escape(result.reason) or 'No reason was given.'}</p>{rest}")


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
    return section("Files", f'<ul class="files">{links}</ul>')


def slam_section(result: Result) -> str:
    """The SLAM plugin's own figures."""
    rows = [(escape(name), escape(figure(value))) for name, value in sorted(result.slam.items())]
    return section("SLAM", table(("figure", "value"), rows, "figures")) if rows else ""


def gate_section(robots: Iterable[RobotHistory]) -> str:
    """Each time the safety gate braked."""
    found = sorted(
        ((stretch, robot.name) for robot in robots for stretch in robot.interventions),
        key=lambda pair: pair[0].begin_s,
    )
    if not found:
        return section("Safety gate", "<p>It never had to brake.</p>")
    rows = [
        (
            f'<a href="#t={one.begin_s:.1f}">{clock(one.begin_s)}</a>',
            f"{one.end_s - one.begin_s:.1f} s",
            escape(name),
            escape(one.held_by),
            escape(one.reason),
        )
        for one, name in found
    ]
    times = "once" if len(rows) == 1 else f"{len(rows)} times"
    held_s = sum(one.end_s - one.begin_s for one, _ in found)
    note = f"braked {times}, {duration(held_s)} in all"
    head = ("at", "for", "robot", "held by", "why at first")
    return section("Safety gate", table(head, rows, "gate"), note)


def nodes_section(robot: RobotHistory, several: bool) -> str:
    """For each node of a tree, how often it was ticked, how long it ran and how it ended."""
    used = list(zip(robot.nodes, robot.tally.nodes, strict=False))
    rows = [_node_row(node, tally) for node, tally in used]
    title = f"Tree of {robot.name}" if several else "Tree"
    head = ("node", "type", "ticks", "running", "longest", "succeeded", "failed", "cut off")
    never = sum(not tally.ticks for _, tally in used)
    note = f"{never} of {len(used)} nodes were never ticked" if never else "every node was ticked"
    return section(title, table(head, rows, "nodes"), note)


def _node_row(node: NodeInfo, tally: NodeTally) -> tuple[str, ...]:
    indent = f"padding-left:{node.path.count('/') * 0.9:.1f}em"
    name = f'<span style="{indent}" title="{escape(node.place, quote=True)}">{escape(node.name)}</span>'
    kind = escape(node.type if node.type != node.name else "")
    times = (duration(span_s) if span_s else "·" for span_s in (tally.running_s, tally.longest_s))
    ends = (f"{count} ×" if count else "·" for count in (tally.successes, tally.failures, tally.cut_off))
    return (name, kind, str(tally.ticks) if tally.ticks else "never", *times, *ends)


def result_section(result: Result) -> str:
    """Everything that is in ``result.json``."""
    rows = [
        (escape(name), f"<code>{escape(_plain(value))}</code>") for name, value in result.as_dict().items()
    ]
    return section("result.json", table(("name", "value"), rows, "figures"))


def _plain(value: object) -> str:
    return str(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False, default=str)

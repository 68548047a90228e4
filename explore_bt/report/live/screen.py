"""The live view's one screen."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from rich.text import Text

from explore_bt.interfaces import Event, RobotSnapshot, RunInfo, TickSnapshot
from explore_bt.report.live.map_dots import MapDots, RobotMark
from explore_bt.report.live.narrator import Narrator
from explore_bt.report.overlay import overlaid
from explore_bt.report.words import clock
from explore_bt.types import Health, OccupancyGrid, Waypoint

__all__ = ["Screen"]

_COLOURS = ("bright_cyan", "bright_yellow", "bright_magenta", "bright_green", "orange1", "bright_red")
_TRAIL_STEP_M = 0.05
_WIDEST, _TALLEST = 150, 44
_LEVEL_STYLES = {"warning": "yellow", "error": "bright_red"}


@dataclass(slots=True)
class _Robot:
    narrator: Narrator
    trail: list[tuple[float, float]]
    colour: str

    def on_tick(self, stamp_s: float, robot: RobotSnapshot) -> None:
        self.narrator.on_tick(stamp_s, robot.nodes)
        x, y = robot.estimate.T_map_base.xy
        if not self.trail or abs(x - self.trail[-1][0]) + abs(y - self.trail[-1][1]) >= _TRAIL_STEP_M:
            self.trail.append((x, y))

    def mark(self, robot: RobotSnapshot) -> RobotMark:
        goal = robot.blackboard.get("goal")
        return RobotMark(
            robot.estimate.T_map_base,
            np.array(self.trail).reshape(-1, 2),
            goal.pose if isinstance(goal, Waypoint) else None,
            self.colour,
        )


class Screen:
    """Remembers trails and reasons, and draws a tick into ``width`` × ``height`` characters."""

    def __init__(self, run: RunInfo, width: int, height: int) -> None:
        self.width, self.height = min(max(width, 40), _WIDEST), min(max(height, 10), _TALLEST)
        self._run = run
        self._robots = {
            name: _Robot(Narrator(nodes), [], _COLOURS[index % len(_COLOURS)])
            for index, (name, nodes) in enumerate(run.trees.items())
        }
        self._map_columns, self._map_rows = round(self.width * 0.56), self.height - 5
        self._dots = MapDots(self._map_columns, self._map_rows)
        self._event: Event | None = None
        self._grids: tuple[OccupancyGrid, ...] = ()
        self._union: OccupancyGrid | None = None

    def on_tick(self, tick: TickSnapshot) -> None:
        """Remember what is drawn later; cheap, for every tick."""
        for robot in tick.robots:
            self._robots[robot.robot].on_tick(tick.stamp_s, robot)

    def on_event(self, event: Event) -> None:
        """Remember the last warning or error."""
        if event.level in _LEVEL_STYLES:
            self._event = event

    def lines(self, tick: TickSnapshot, wall_factor: float) -> list[Text]:
        """The whole screen; no line is longer than the width."""
        lines = [self._title(tick, wall_factor), self._figures(tick), Text("─" * self.width, "grey42")]
        words = list(self._words(tick))
        field = self._map(tick)
        for row in range(self._map_rows):
            line = field[row]
            line.append("  ")
            line.append_text(words[row] if row < len(words) else Text())
            lines.append(line)
        lines += [Text("─" * self.width, "grey42"), self._footer()]
        for line in lines:
            line.truncate(self.width)
        return lines

    def _title(self, tick: TickSnapshot, wall_factor: float) -> Text:
        right = f"{clock(tick.stamp_s)}   {wall_factor:.3g} × real time"
        left = Text.assemble(("explore-bt ", "bold"), (self._run.mission, "bold bright_cyan"))
        left.truncate(max(0, self.width - len(right) - 1), overflow="ellipsis")
        left.pad_right(max(1, self.width - left.cell_len - len(right)))
        return left.append(right, "grey70")

    def _figures(self, tick: TickSnapshot) -> Text:
        scores = [robot.score for robot in tick.robots]
        shares = [score.coverage for score in scores if score.coverage is not None]
        contacts = [score.contacts for score in scores if score.contacts is not None]
        speed = max((abs(robot.motion.twist.linear_mps) for robot in tick.robots), default=0.0)
        figures = f"{sum(score.distance_m for score in scores):6.1f} m  {speed:.2f} m/s"
        line = Text()
        if shares:
            length = self.width - len(figures) - (30 if contacts else 17)
            line.append_text(_bar(max(shares), max(length, 5))).append(f" {max(shares) * 100:5.1f} % mapped ")
        line.append(figures)
        if contacts:
            count = sum(contacts)
            words = f"  {count} contact{'' if count == 1 else 's'}"
            line.append(words, "bright_red" if count else "green")
        return line

    def _map(self, tick: TickSnapshot) -> list[Text]:
        grids = tuple(robot.grid for robot in tick.robots)
        if self._union is None or any(a is not b for a, b in zip(grids, self._grids, strict=True)):
            self._grids, self._union = grids, overlaid(grids)
        return self._dots.lines(self._union, [self._robots[robot.robot].mark(robot) for robot in tick.robots])

    def _words(self, tick: TickSnapshot) -> Iterator[Text]:
        width = self.width - self._map_columns - 2
        room = self._map_rows // len(tick.robots)
        for robot in tick.robots:
            about = list(self._about(robot, width, several=len(tick.robots) > 1))[:room]
            yield from about
            yield from [Text()] * (room - len(about) if len(tick.robots) > 1 else 0)

    def _about(self, robot: RobotSnapshot, width: int, several: bool) -> Iterator[Text]:
        own = self._robots[robot.robot]
        if several:
            yield Text(robot.robot, f"bold {own.colour}")
        for depth, (info, _) in enumerate(own.narrator.branch()):
            indent = "  " * (depth - 1) + "└ " if depth else ""
            yield Text.assemble((indent, "grey42"), (info.name, "bold" if depth else "bold bright_white"))
        if robot.gate_reason:
            yield from _wrapped(f"braking: {robot.gate_reason}", width, "yellow")
        if robot.estimate.health is not Health.OK:
            yield from _wrapped(f"SLAM {robot.estimate.health}: {robot.estimate.reason}", width, "yellow")
        if not several:
            yield Text()
        for index, reason in enumerate(own.narrator.reasons(6)):
            yield Text.assemble((f"{clock(reason.stamp_s)} ", "grey50"), (reason.leaf, "bright_cyan"))
            yield from _wrapped(reason.words, width, "" if index == 0 else "grey70")

    def _footer(self) -> Text:
        if self._event is None:
            return Text("Ctrl-C stops safely and keeps everything", "grey50")
        event = self._event
        words = f"{clock(event.stamp_s)} {event.source}: {event.message}"
        line = Text(" ".join(words.split()), _LEVEL_STYLES[event.level])
        line.truncate(self.width, overflow="ellipsis")
        return line


def _bar(share: float, length: int) -> Text:
    eighths = round(min(max(share, 0.0), 1.0) * length * 8)
    part = " ▏▎▍▌▋▊▉"[eighths % 8] if eighths % 8 else ""
    line = Text().append("█" * (eighths // 8) + part, "bright_cyan on grey23")
    return line.append(" " * (length - len(line)), "on grey23")


def _wrapped(words: str, width: int, style: str) -> Iterator[Text]:
    for line in textwrap.wrap(words, max(width - 2, 8), max_lines=4, placeholder=" …"):
        yield Text("  " + line, style)

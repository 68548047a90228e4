"""A plain line about every ten seconds, where no live view can be drawn."""

from __future__ import annotations

from collections.abc import Mapping

import typer

from explore_bt.cli.human import duration, percent
from explore_bt.clock import Clock, WallClock
from explore_bt.interfaces import (
    API_VERSION,
    NodeInfo,
    PluginOptions,
    RobotSnapshot,
    RunInfo,
    Sink,
    TickSnapshot,
)
from explore_bt.types import Result
from explore_bt.units import Duration

__all__ = ["Progress"]


class Progress(Sink):
    """One line per robot and period of wall time: coverage, distance, and what the tree is about."""

    name = "progress"
    api_version = API_VERSION

    class Options(PluginOptions):
        """How often."""

        every: Duration = 10.0

    options: Options

    def __init__(self, options: PluginOptions, clock: Clock | None = None) -> None:
        super().__init__(options)
        self._clock = clock or WallClock()
        self._next_s = 0.0
        self._trees: Mapping[str, tuple[NodeInfo, ...]] = {}

    def open(self, run: RunInfo) -> None:
        """Remember the trees and say that the run begins."""
        self._trees = run.trees
        self._next_s = self._clock.now_s() + self.options.every
        typer.echo(f"running {run.mission}, seed {run.seed}, into {run.folder}")

    def on_tick(self, tick: TickSnapshot) -> None:
        """A line per robot if it is time for one."""
        if self._clock.now_s() < self._next_s:
            return
        self._next_s = self._clock.now_s() + self.options.every
        for robot in tick.robots:
            name = f"{robot.robot}: " if len(tick.robots) > 1 else ""
            typer.echo(f"{duration(tick.stamp_s):>12}  {name}{_figures(robot)}  {self._about(robot)}".rstrip())

    def close(self, result: Result | None) -> None:
        """Nothing: the summary follows."""

    def _about(self, robot: RobotSnapshot) -> str:
        """The deepest running node and its reason: parents come before children, so it is the last one."""
        infos = self._trees.get(robot.robot, ())
        running = [pair for pair in zip(infos, robot.nodes, strict=True) if pair[1].status == "running"]
        if not running:
            return ""
        info, state = running[-1]
        return f"{info.name}: {state.message}" if state.message else info.name


def _figures(robot: RobotSnapshot) -> str:
    score = robot.score
    covered = "" if score.coverage is None else f"{percent(score.coverage):>7} mapped  "
    return f"{covered}{score.distance_m:6.1f} m"

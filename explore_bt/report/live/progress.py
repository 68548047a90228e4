"""The sink that tells a run in plain lines: for logs, pipes and continuous integration."""

from __future__ import annotations

import time
from collections.abc import Callable

from pydantic import Field
from rich.console import Console

from explore_bt.interfaces import API_VERSION, PluginOptions, RobotSnapshot, RunInfo, Sink, TickSnapshot
from explore_bt.report.live.narrator import Narrator
from explore_bt.report.words import clock
from explore_bt.types import Result
from explore_bt.units import Duration

__all__ = ["ProgressLines", "ProgressLinesOptions"]


class ProgressLinesOptions(PluginOptions):
    """How often a line is written."""

    period: Duration = Field(10.0, gt=0, description="wall time between two lines")


class ProgressLines(Sink):
    """One line about every ten seconds of wall time: ``0:42  31 % mapped · 12.4 m · drive_to: ...``."""

    name = "progress"
    api_version = API_VERSION
    Options = ProgressLinesOptions

    def __init__(
        self,
        options: PluginOptions,
        console: Console | None = None,
        wall_s: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(options)
        self._period_s = ProgressLinesOptions.model_validate(options.model_dump()).period
        self._console = console
        self._wall_s = wall_s
        self._narrators: dict[str, Narrator] = {}
        self._due_s = 0.0

    def open(self, run: RunInfo) -> None:
        """The first line comes after one period."""
        self._narrators = {name: Narrator(nodes) for name, nodes in run.trees.items()}
        self._due_s = self._wall_s() + self._period_s

    def on_tick(self, tick: TickSnapshot) -> None:
        """Listen to every tick; write if it is time."""
        for robot in tick.robots:
            self._narrators[robot.robot].on_tick(tick.stamp_s, robot.nodes)
        if self._wall_s() < self._due_s:
            return
        self._due_s = self._wall_s() + self._period_s
        console = self._console or Console()
        for robot in tick.robots:
            name = f"{robot.robot}  " if len(tick.robots) > 1 else ""
            words = f"{clock(tick.stamp_s)}  {name}{self._about(robot)}"
            console.print(words, highlight=False, markup=False, soft_wrap=True)

    def close(self, result: Result | None) -> None:
        """Nothing is left to say: the summary is the command line's."""

    def _about(self, robot: RobotSnapshot) -> str:
        score = robot.score
        parts = [] if score.coverage is None else [f"{score.coverage * 100:.0f} % mapped"]
        parts += [f"{score.distance_m:.1f} m", " ".join(self._narrators[robot.robot].newest().split())]
        return " · ".join(part for part in parts if part)

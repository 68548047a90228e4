"""A sink that writes down who was greeted."""

from __future__ import annotations

from pydantic import Field

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.types import Result

__all__ = ["VisitorsBook"]


class VisitorsBook(Sink):
    """Keeps every greeting of the blackboard in visitors.txt."""

    name = "visitors_book"
    api_version = API_VERSION

    class Options(PluginOptions):
        """Which blackboard entry holds the greeting."""

        entry: str = Field("greeting", description="the blackboard entry to watch")

    options: Options

    def open(self, run: RunInfo) -> None:
        """Open the book at a blank page."""
        self._file = run.folder / "visitors.txt"
        self._lines: list[str] = []

    def on_tick(self, tick: TickSnapshot) -> None:
        """Write a line for every greeting that is new."""
        for robot in tick.robots:
            line = f"{robot.robot}: {robot.blackboard.get(self.options.entry)}"
            if self.options.entry in robot.blackboard and line not in self._lines:
                self._lines.append(line)

    def close(self, result: Result | None) -> None:  # noqa: ARG002  # the book holds visitors, not results
        """Put the book away."""
        if self._lines:
            write_whole(self._file, "\n".join(self._lines) + "\n")

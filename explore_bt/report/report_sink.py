"""The sink that writes the report when the run is over."""

from __future__ import annotations

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.report.map_view import map_view_png
from explore_bt.report.page import report_page
from explore_bt.report.run_history import RunHistory
from explore_bt.types import Result

__all__ = ["ReportSink"]


class ReportSink(Sink):
    """Writes ``map_view.png`` and ``report.html`` into the run's folder."""

    name = "report"
    wants_past = True
    api_version = API_VERSION

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._history: RunHistory | None = None

    def open(self, run: RunInfo) -> None:
        """Begin a new history."""
        self._history = RunHistory.of(run)

    def on_tick(self, tick: TickSnapshot) -> None:
        """Take in one tick."""
        if self._history is not None:
            self._history.on_tick(tick)

    def on_event(self, event: Event) -> None:
        """Take in one event."""
        if self._history is not None:
            self._history.on_event(event)

    def close(self, result: Result | None) -> None:
        """Write both files; without a result there was no run, and nothing is written."""
        history, self._history = self._history, None
        if history is None or result is None:
            return
        picture = map_view_png(history, result)
        if picture is not None:
            write_whole(history.run.folder / "map_view.png", picture)
        write_whole(history.run.folder / "report.html", report_page(history, result))

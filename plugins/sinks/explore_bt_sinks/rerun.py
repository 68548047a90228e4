"""A running mission in Rerun: into a viewer that opens, to viewers that connect, or into a file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from explore_bt import hookimpl
from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.plugin import require
from explore_bt.types import Result
from explore_bt.units import Duration

if TYPE_CHECKING:
    import rerun

    from explore_bt_sinks.rerun_robot import RerunRobot

require("rerun", "rerun")

__all__ = ["RerunLive", "RerunLiveOptions", "explore_bt_register"]

_LEVELS = {"debug": "DEBUG", "info": "INFO", "warning": "WARN", "error": "ERROR"}


class RerunLiveOptions(PluginOptions):
    """Where the run is shown."""

    to: Literal["viewer", "server", "file"] = Field(
        "viewer", description="open a viewer, serve viewers that connect, or write rerun.rrd beside the map"
    )
    port: int = Field(9876, ge=1, le=65535, description="where the server listens, on every address")
    map_period: Duration = Field(1.0, gt=0, description="mission time between maps")
    scan_period: Duration = Field(0.2, gt=0, description="mission time between scans")


class RerunLive(Sink):
    """Shows map, scan, path, free sectors, people, tree, figures and events on the timeline ``mission``."""

    name = "rerun"
    api_version = API_VERSION
    Options = RerunLiveOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = RerunLiveOptions.model_validate(options.model_dump())
        self._stream: rerun.RecordingStream | None = None
        self._robots: dict[str, RerunRobot] = {}

    def open(self, run: RunInfo) -> None:
        """Open viewer, server or file.

        Raises:
            PluginError: the viewer cannot be started, or the port is taken.
        """
        import rerun

        from explore_bt_sinks.rerun_robot import RerunRobot

        stream = rerun.RecordingStream(f"explore-bt {run.mission}")
        try:
            if self._settings.to == "viewer":
                stream.spawn()
            elif self._settings.to == "server":
                stream.serve_grpc(grpc_port=self._settings.port)
            else:
                stream.save(run.folder / "rerun.rrd")
        except (OSError, RuntimeError) as error:
            raise PluginError(f"rerun: {self._settings.to} cannot be opened: {error}") from None
        self._stream = stream
        self._robots = {
            name: RerunRobot(stream, name, nodes, run.footprint_radius_m[name], self._settings)
            for name, nodes in run.trees.items()
        }

    def on_tick(self, tick: TickSnapshot) -> None:
        """Show what has changed."""
        if self._stream is None:
            return
        self._stream.set_time("mission", duration=tick.stamp_s)
        for robot in tick.robots:
            self._robots[robot.robot].show(tick.stamp_s, robot)

    def on_event(self, event: Event) -> None:
        """Show the event's line."""
        if self._stream is None:
            return
        import rerun

        self._stream.set_time("mission", duration=event.stamp_s)
        source = "/".join(filter(None, (event.robot, event.source)))
        level = _LEVELS.get(event.level, "INFO")
        self._stream.log("events", rerun.TextLog(f"{source}: {event.message}", level=level))

    def close(self, result: Result | None) -> None:
        """Say how it ended and let go."""
        stream, self._stream = self._stream, None
        if stream is None:
            return
        if result is not None:
            import rerun

            stream.log("events", rerun.TextLog(f"{result.outcome}: {result.reason}", level="INFO"))
        stream.flush()
        stream.disconnect()


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """The sink of this module."""
    return [RerunLive]

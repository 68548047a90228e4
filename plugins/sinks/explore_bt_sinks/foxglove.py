"""A running mission in Foxglove: the recording's messages over a WebSocket."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from pydantic import Field

from explore_bt import hookimpl
from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.plugin import require
from explore_bt.recording import (
    ROBOT_TOPICS,
    RUN_TOPICS,
    McapRecorderOptions,
    RobotTrack,
    log_message,
    periods_of,
    result_message,
    run_message,
    schema_text,
    stamp_ns,
)
from explore_bt.types import Result

if TYPE_CHECKING:
    import foxglove
    from foxglove.websocket import WebSocketServer

    from explore_bt_sinks.late_comers import LateComers

require("foxglove", "foxglove")

__all__ = ["FoxgloveLive", "FoxgloveLiveOptions", "explore_bt_register"]

_LAST_WORDS_S = 0.3
"""Until clients have the result: the server hangs up with what it has not sent yet."""
_NOT_SHOWN = "measured"  # what SLAM is given: megabytes for nobody's eye


class FoxgloveLiveOptions(PluginOptions):
    """Where Foxglove finds the run."""

    host: str = Field("127.0.0.1", description="address to listen on; anyone who can reach it may look on")
    port: int = Field(8765, ge=0, le=65535, description="port to listen on; 0: a free one")


class FoxgloveLive(Sink):
    """Serves the recording's messages to Foxglove while the mission runs; who comes late gets the newest."""

    name = "foxglove"
    api_version = API_VERSION
    Options = FoxgloveLiveOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = FoxgloveLiveOptions.model_validate(options.model_dump())
        self._context: foxglove.Context | None = None  # its channels close when nobody holds it
        self._server: WebSocketServer | None = None
        self._channels: dict[str, foxglove.Channel] = {}
        self._tracks: dict[str, RobotTrack] = {}
        self._late_comers: LateComers | None = None
        self._time_ns = 0

    @property
    def port(self) -> int:
        """Where it listens; 0 while it does not."""
        return self._server.port if self._server else 0

    def open(self, run: RunInfo) -> None:
        """Begin to listen.

        Raises:
            PluginError: the port is taken, or the address is none of this machine's.
        """
        import foxglove

        from explore_bt_sinks.late_comers import LateComers

        context = self._context = foxglove.Context()
        topics = [(topic.pattern, topic.schema) for topic in RUN_TOPICS]
        topics += [(topic.of(robot), topic.schema) for robot in run.trees for topic in ROBOT_TOPICS]
        self._channels = {
            topic: foxglove.Channel(
                topic,
                schema=foxglove.Schema(name=schema, encoding="jsonschema", data=schema_text(schema)),
                message_encoding="json",
                context=context,
            )
            for topic, schema in topics
            if not topic.endswith(f"/{_NOT_SHOWN}")
        }
        self._late_comers = LateComers(self._channels)
        host, port = self._settings.host, self._settings.port
        try:
            self._server = foxglove.start_server(
                name=run.mission, host=host, port=port, context=context, server_listener=self._late_comers
            )
        except (OSError, RuntimeError) as error:
            hint = "give another with the option port"
            raise PluginError(f"foxglove cannot listen on {host}:{port}: {error}; {hint}") from None
        periods = periods_of(McapRecorderOptions.model_validate({}))
        self._tracks = {robot: RobotTrack(robot, self._send, periods, clouds=False) for robot in run.trees}
        self._send("/run", 0, run_message(run))

    def on_tick(self, tick: TickSnapshot) -> None:
        """Send what has changed."""
        self._time_ns = stamp_ns(tick.stamp_s)
        for robot in tick.robots:
            self._tracks[robot.robot].on_tick(self._time_ns, tick.index, robot)

    def on_event(self, event: Event) -> None:
        """Send the event's line."""
        if self._server is not None:
            time_ns = stamp_ns(event.stamp_s)
            self._send("/events", time_ns, log_message(time_ns, event))

    def close(self, result: Result | None) -> None:
        """Send the last maps and the result, then hang up."""
        server, self._server = self._server, None
        if server is None:
            return
        for track in self._tracks.values():
            track.close(self._time_ns)
        if result is not None:
            self._send("/result", self._time_ns, result_message(result))
            time.sleep(_LAST_WORDS_S)
        for channel in self._channels.values():
            channel.close()
        server.stop()

    def _send(self, topic: str, time_ns: int, text: str) -> None:
        channel = self._channels.get(topic)
        if channel is not None and self._late_comers is not None:
            data = text.encode("utf-8", "backslashreplace")
            self._late_comers.keep(topic, time_ns, data)
            channel.log(data, log_time=time_ns)


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """The sink of this module."""
    return [FoxgloveLive]

"""What somebody gets who begins to look at a topic of a running mission."""

from __future__ import annotations

import threading

import foxglove
from foxglove.websocket import ChannelView, Client, ServerListener

__all__ = ["LateComers"]


class LateComers(ServerListener):
    """Gives who subscribes the newest message of the topic: a map that has not changed is not sent again.

    ``on_subscribe`` is called by the server's thread.
    """

    def __init__(self, channels: dict[str, foxglove.Channel]) -> None:
        self._channels = channels
        self._newest: dict[str, tuple[int, bytes]] = {}
        self._lock = threading.Lock()

    def keep(self, topic: str, time_ns: int, data: bytes) -> None:
        """Remember a message in place of the one before."""
        with self._lock:
            self._newest[topic] = (time_ns, data)

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Somebody wants to see a topic."""
        with self._lock:
            newest = self._newest.get(channel.topic)
        if newest is not None:
            time_ns, data = newest
            self._channels[channel.topic].log(data, log_time=time_ns, sink_id=client.id)

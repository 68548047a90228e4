"""The two sockets of a server."""

from __future__ import annotations

import contextlib
from typing import Any

import zmq

from explore_bt.errors import UserError

__all__ = ["Ends"]

_LARGEST_BYTES = 1_000_000


class Ends:
    """Requests at ``port``, notices to all at the next.

    They may be bound in one thread and used in another. Clients ask with REQ sockets; the answering one is a
    ROUTER and not a REP, which can be made to wait for ever for the rest of what a stranger has begun to say.

    Raises:
        UserError: a port cannot be had.
    """

    def __init__(self, host: str, port: int) -> None:
        self._context: Any = zmq.Context()
        self._requests: Any = self._context.socket(zmq.ROUTER)
        self._notices: Any = self._context.socket(zmq.PUB)
        for socket, number in ((self._requests, port), (self._notices, port + 1)):
            socket.setsockopt(zmq.LINGER, 0)
            socket.setsockopt(zmq.MAXMSGSIZE, _LARGEST_BYTES)
            try:
                socket.bind(f"tcp://{host}:{number}")
            except zmq.ZMQError as error:
                self.close()
                reason = (error.strerror or str(error)).lower()
                raise UserError(
                    f"the Groot2 server cannot have {host}:{number}: {reason}; give another --groot-port"
                ) from None

    def next_request(self, patience_ms: int) -> tuple[bytes, list[bytes]] | None:
        """Who asks, and the frames of the question; None if nobody asked anything meanwhile."""
        if not self._requests.poll(patience_ms):
            return None
        try:
            client, *frames = self._requests.recv_multipart(zmq.NOBLOCK)
        except zmq.Again:
            return None
        if len(frames) < 2 or frames[0]:  # not from a REQ socket
            return None
        return client, frames[1:]

    def answer(self, client: bytes, frames: list[bytes]) -> None:
        """Answer a client; one that has gone, or does not take its answers, is passed over."""
        with contextlib.suppress(zmq.Again):
            self._requests.send_multipart([client, b"", *frames], zmq.NOBLOCK)

    def tell_all(self, frames: list[bytes]) -> None:
        """Tell whoever has subscribed and keeps up."""
        with contextlib.suppress(zmq.Again):
            self._notices.send_multipart(frames, zmq.NOBLOCK)

    def close(self) -> None:
        """Give both back; what was not sent yet is lost. Idempotent."""
        self._context.destroy(linger=0)

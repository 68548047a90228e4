"""The two sockets of a server."""

from __future__ import annotations

from typing import Any

import zmq

from explore_bt.errors import UserError

__all__ = ["Ends"]

_LARGEST_BYTES = 1_000_000
_SLOW_CLIENT_MS = 1000


class Ends:
    """Requests at ``port``, notices to all at the next.

    They may be bound in one thread and used in another.

    Raises:
        UserError: a port cannot be had.
    """

    def __init__(self, host: str, port: int) -> None:
        self._context: Any = zmq.Context()
        self.requests: Any = self._context.socket(zmq.REP)
        self.notices: Any = self._context.socket(zmq.PUB)
        for socket, number in ((self.requests, port), (self.notices, port + 1)):
            socket.setsockopt(zmq.LINGER, 0)
            socket.setsockopt(zmq.MAXMSGSIZE, _LARGEST_BYTES)
            socket.setsockopt(zmq.SNDTIMEO, _SLOW_CLIENT_MS)
            try:
                socket.bind(f"tcp://{host}:{number}")
            except zmq.ZMQError as error:
                self.close()
                reason = (error.strerror or str(error)).lower()
                raise UserError(
                    f"the Groot2 server cannot have {host}:{number}: {reason}; give another --groot-port"
                ) from None

    def close(self) -> None:
        """Give both back; what was not sent yet is lost. Idempotent."""
        self._context.destroy(linger=0)

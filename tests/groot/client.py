"""A client that speaks the Groot2 protocol by hand."""

from __future__ import annotations

import contextlib
import json
import socket
import struct

import zmq

PATIENCE_MS = 20_000


def free_port(count: int = 2) -> int:
    """The first of ``count`` neighbouring ports that nobody has."""
    while True:
        with contextlib.ExitStack() as held:
            first = held.enter_context(socket.socket())
            first.bind(("127.0.0.1", 0))
            port: int = first.getsockname()[1]
            try:
                for number in range(port + 1, port + count):
                    held.enter_context(socket.socket()).bind(("127.0.0.1", number))
            except (OSError, OverflowError):
                continue
            return port


class RefusedError(Exception):
    """The server answered with an error."""


class Client:
    """Speaks the protocol by hand."""

    def __init__(self, port: int) -> None:
        self._context = zmq.Context()
        self._requests = self._context.socket(zmq.REQ)
        self.notices = self._context.socket(zmq.SUB)
        self.notices.setsockopt(zmq.SUBSCRIBE, b"")
        for each, number in ((self._requests, port), (self.notices, port + 1)):
            each.setsockopt(zmq.LINGER, 0)
            each.setsockopt(zmq.RCVTIMEO, PATIENCE_MS)
            each.connect(f"tcp://127.0.0.1:{number}")
        self._number = 0
        self.identities: set[bytes] = set()

    def raw(self, *frames: bytes) -> list[bytes]:
        self._requests.send_multipart(frames)
        return self._requests.recv_multipart()

    def ask(self, letter: str, payload: object = None) -> bytes:
        self._number += 1
        header = struct.pack("<BcI", 2, letter.encode(), self._number)
        text = payload if isinstance(payload, str) else json.dumps(payload)
        answer = self.raw(header, *([] if payload is None else [text.encode()]))
        if answer[0] == b"error":
            raise RefusedError(answer[1].decode())
        assert answer[0][:6] == header
        assert len(answer[0]) == 22
        self.identities.add(answer[0][6:])
        return answer[1] if len(answer) > 1 else b""

    def statuses(self) -> dict[int, int]:
        return dict(struct.iter_unpack("<HB", self.ask("S")))

    def close(self) -> None:
        self._context.destroy(linger=0)

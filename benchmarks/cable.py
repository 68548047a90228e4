"""A bad cable between two network namespaces: delay, loss, a narrow rate, a cut.

Each end is a tap device in a namespace of its own; this process carries the frames from one to the other. So
it needs root, ``ip`` and ``/dev/net/tun``, and not the kernel's netem, which many a kernel lacks.
"""

from __future__ import annotations

import contextlib
import fcntl
import heapq
import os
import random
import selectors
import shutil
import struct
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

__all__ = ["Cable", "CableError", "Trouble", "cable"]

_TUNSETIFF, _TAP, _NO_PACKET_INFO = 0x400454CA, 0x0002, 0x1000
_LONGEST_FRAME = 65536
_LOOK_S = 0.05
_BUFFER_S = 1.0
"""What waits longer than this at the narrow place is thrown away, as routers do."""


class CableError(Exception):
    """This machine lets nobody lay one; says what is missing."""


@dataclass(frozen=True, slots=True)
class Trouble:
    """What the cable does to every frame, in each direction.

    Attributes:
        delay_s: each way.
        loss: share of the frames.
        rate_bytes_per_s: bytes a second; 0 for as many as come.
    """

    delay_s: float = 0.0
    loss: float = 0.0
    rate_bytes_per_s: float = 0.0


class Cable:
    """Carries frames until it is closed.

    Attributes:
        spaces: names of the two namespaces.
        addresses: IPv4 of its ends, in the same order.
        sent_bytes: that went in at each end, lost ones included.
        is_cut: nothing comes through; may be set at any time.
    """

    def __init__(self, trouble: Trouble, seed: int = 1) -> None:
        self._trouble, self._chance = trouble, random.Random(seed)
        mark = os.getpid() % 10000
        self.spaces = (f"ebt{mark}a", f"ebt{mark}b")
        self.addresses = ("10.78.0.1", "10.78.0.2")
        self.sent_bytes = [0, 0]
        self.is_cut = False
        self._ends: list[int] = []
        self._free_s = [0.0, 0.0]
        self._under_way: list[tuple[float, int, int, bytes]] = []
        self._count = 0
        self._is_open = True
        self._thread = threading.Thread(target=self._carry, name="cable", daemon=True)

    def lay(self) -> None:
        """Make namespaces and ends, and begin to carry.

        Raises:
            CableError: that may not be.
        """
        if shutil.which("ip") is None or os.geteuid() != 0 or not os.path.exists("/dev/net/tun"):
            raise CableError("a bad cable needs root, ip and /dev/net/tun")
        for space, address in zip(self.spaces, self.addresses, strict=True):
            try:
                _ip("netns", "add", space)
                end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
                self._ends.append(end)
                fcntl.ioctl(end, _TUNSETIFF, struct.pack("16sH", space.encode(), _TAP | _NO_PACKET_INFO))
                _ip("link", "set", space, "netns", space)
                _ip("-n", space, "addr", "add", f"{address}/24", "dev", space)
                _ip("-n", space, "link", "set", "lo", "up")
                _ip("-n", space, "link", "set", space, "up")
            except (OSError, subprocess.CalledProcessError) as fault:
                raise CableError(f"this machine lets nobody make network namespaces: {fault}") from None
        self._thread.start()

    def close(self) -> None:
        """Take it away, and the namespaces."""
        self._is_open = False
        if self._thread.is_alive():
            self._thread.join()
        for end in self._ends:
            os.close(end)
        for space in self.spaces:
            subprocess.run(["ip", "netns", "del", space], capture_output=True, check=False)

    def _carry(self) -> None:
        with selectors.DefaultSelector() as waiting:
            for side, end in enumerate(self._ends):
                waiting.register(end, selectors.EVENT_READ, side)
            while self._is_open:
                due_s = self._under_way[0][0] - time.monotonic() if self._under_way else _LOOK_S
                for key, _ in waiting.select(min(max(due_s, 0.0), _LOOK_S)):
                    self._take_in(key.data)
                self._put_out()

    def _take_in(self, side: int) -> None:
        with contextlib.suppress(BlockingIOError):
            while True:
                frame = os.read(self._ends[side], _LONGEST_FRAME)
                self.sent_bytes[side] += len(frame)
                if not self.is_cut and self._chance.random() >= self._trouble.loss:
                    self._send_on(side, frame)

    def _send_on(self, side: int, frame: bytes) -> None:
        now_s = time.monotonic()
        begin_s = max(self._free_s[side], now_s)
        if begin_s - now_s > _BUFFER_S:
            return
        takes_s = len(frame) / self._trouble.rate_bytes_per_s if self._trouble.rate_bytes_per_s else 0.0
        self._free_s[side] = begin_s + takes_s
        self._count += 1  # of two that are due at once the first goes first
        comes_s = self._free_s[side] + self._trouble.delay_s
        heapq.heappush(self._under_way, (comes_s, self._count, 1 - side, frame))

    def _put_out(self) -> None:
        while self._under_way and self._under_way[0][0] <= time.monotonic():
            _, _, side, frame = heapq.heappop(self._under_way)
            if self.is_cut:
                continue
            with contextlib.suppress(OSError):  # the end is not up
                os.write(self._ends[side], frame)


@contextmanager
def cable(trouble: Trouble, seed: int = 1) -> Iterator[Cable]:
    """A cable while inside.

    Raises:
        CableError: this machine lets nobody lay one.
    """
    laid = Cable(trouble, seed)
    try:
        laid.lay()
        yield laid
    finally:
        laid.close()


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], capture_output=True, check=True, text=True)

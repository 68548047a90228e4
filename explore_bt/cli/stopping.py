"""Ctrl-C and SIGTERM raise the stop flag; the robot brakes and the results are saved."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explore_bt.runtime import StopFlag

__all__ = ["stopping_by_signal"]

_AGAIN = b"\nstill stopping; Ctrl-\\ ends the program at once and loses what is not saved yet\n"
_NAMES = {signal.SIGINT: "Ctrl-C", signal.SIGTERM: "SIGTERM"}


@contextmanager
def stopping_by_signal(
    stop: StopFlag, *, then: str = "the robot brakes, then the results are saved"
) -> Iterator[None]:
    """While inside, the two signals raise ``stop`` instead of ending the program, and say what comes then."""
    first = f"\nstopping: {then}\n".encode()

    def on_signal(number: int, _frame: FrameType | None) -> None:
        # os.write: print is not safe in a handler, the interrupted code may be printing
        os.write(2, _AGAIN if stop.is_raised else first)
        stop.raise_flag(f"stopped by hand ({_NAMES[signal.Signals(number)]})")

    before = {number: signal.signal(number, on_signal) for number in _NAMES}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)

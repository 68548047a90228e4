"""Telling clients, who may be slow, stuck or dead, without ever waiting for them."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from queue import SimpleQueue
from typing import Generic, TypeVar

__all__ = ["Errands", "Listener"]

T = TypeVar("T")

_log = logging.getLogger("explore_bt")


class Errands:
    """Runs small jobs one after the other in a thread of its own: answers given to their futures.

    A job that blocks keeps the later ones waiting, never the caller of ``run``.
    """

    def __init__(self) -> None:
        self._jobs: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="debugger's answers", daemon=True)
        self._thread.start()

    def run(self, job: Callable[[], None]) -> None:
        """Have a job done."""
        self._jobs.put(job)

    def close(self, patience_s: float) -> None:
        """Have what is left done, and wait for that a little."""
        self._jobs.put(None)
        self._thread.join(patience_s)

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                job()
            except Exception:
                _log.exception("an answer of the debugger was not taken")


class Listener(Generic[T]):
    """Passes values on to one callback, in a thread of its own; while it is busy only the newest is kept."""

    def __init__(self, callback: Callable[[T], None]) -> None:
        self._callback = callback
        self._news = threading.Condition()
        self._newest: list[T] = []
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="debugger's listener", daemon=True)
        self._thread.start()

    def tell(self, value: T) -> None:
        """Have a value passed on, in place of any that has not been yet."""
        with self._news:
            self._newest = [value]
            self._news.notify()

    def close(self) -> None:
        """Pass on what is left, then no more."""
        with self._news:
            self._closed = True
            self._news.notify()

    def _work(self) -> None:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._newest or self._closed)
                if not self._newest:
                    return
                (value,), self._newest = self._newest, []
            try:
                self._callback(value)
            except Exception:
                _log.exception("a listener of the debugger failed")

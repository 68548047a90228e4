"""Commands on their way from any thread to the tick thread, and their answers on the way back."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

from explore_bt.debug.commands import Command
from explore_bt.debug.herald import Errands
from explore_bt.errors import DebugError, UserError

__all__ = ["CommandQueue"]

T = TypeVar("T")

_log = logging.getLogger("explore_bt")

MOST_WAITING = 1000
_PATIENCE_S = 2.0


class CommandQueue:
    """Bounded, also in answers that nobody takes: who floods it is refused and holds nobody up."""

    def __init__(self) -> None:
        self._commands: SimpleQueue[tuple[Command[Any], Future[Any]]] = SimpleQueue()
        self._lock = threading.Lock()
        self._waiting = 0
        self._closed = ""
        self._errands = Errands()

    def submit(self, command: Command[T]) -> Future[T]:
        """The future of a command's answer; refused at once with a ``DebugError`` in it."""
        future: Future[T] = Future()
        with self._lock:
            refusal = self._refusal(command)
            if not refusal:
                self._waiting += 1
                self._commands.put((command, future))
        if refusal:
            future.set_exception(DebugError(refusal))
        return future

    def serve(self, do: Callable[[Command[Any]], object], patience_s: float = 0.0) -> bool:
        """Have ``do`` answer the next command, waiting so long for one; whether there was one."""
        waits = patience_s > 0.0
        if not waits and self._commands.empty():  # as almost always
            return False
        try:
            command, future = self._commands.get(waits, patience_s if waits else None)
        except Empty:
            return False
        try:
            answer = do(command)
        except UserError as refusal:
            self._deliver(future, refusal, failed=True)
        except Exception as fault:  # nonsense in a command must not become the tick thread's
            _log.debug("%s was not understood", type(command).__name__, exc_info=True)
            nonsense = DebugError(f"{type(command).__name__} cannot be done: {fault!r}")
            self._deliver(future, nonsense, failed=True)
        else:
            self._deliver(future, answer, failed=False)
        return True

    def close(self, reason: str) -> None:
        """Refuse what still waits, and all that comes."""
        with self._lock:
            self._closed = reason

        def refuse(_: Command[Any]) -> object:
            raise DebugError(reason)

        while self.serve(refuse):
            pass
        self._errands.close(_PATIENCE_S)

    def _refusal(self, command: object) -> str:
        if not isinstance(command, Command):
            return f"{type(command).__name__} is not a command of the debugger"
        if self._closed:
            return self._closed
        if self._waiting >= MOST_WAITING:
            return f"{MOST_WAITING} commands wait for an answer already; wait for them first"
        return ""

    def _deliver(self, future: Future[Any], answer: object, *, failed: bool) -> None:
        """In a thread of its own: whoever waits for the future may run code of theirs at once."""

        def deliver() -> None:
            with self._lock:
                self._waiting -= 1
            if not future.set_running_or_notify_cancel():
                return
            if failed:
                assert isinstance(answer, BaseException)
                future.set_exception(answer)
            else:
                future.set_result(answer)

        self._errands.run(deliver)

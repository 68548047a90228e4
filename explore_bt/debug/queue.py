"""Commands on their way from any thread to the tick thread, and their answers on the way back."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

from explore_bt.debug.commands import Command
from explore_bt.debug.herald import Errands
from explore_bt.errors import DebugError

__all__ = ["CommandQueue"]

T = TypeVar("T")

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

    def serve(self, do: Callable[[Command[Any]], object], patience_s: float, most: int) -> None:
        """Have ``do`` answer up to ``most`` commands, waiting so long for the first."""
        for _ in range(most):
            try:
                command, future = self._commands.get(timeout=patience_s) if patience_s else self._at_once()
            except Empty:
                return
            patience_s = 0.0
            try:
                answer = do(command)
            except Exception as fault:  # a client's fault must not become the tick thread's
                self._deliver(future, fault, failed=True)
            else:
                self._deliver(future, answer, failed=False)

    def close(self, reason: str) -> None:
        """Refuse what still waits, and all that comes."""
        with self._lock:
            self._closed = reason

        def refuse(_: Command[Any]) -> object:
            raise DebugError(reason)

        self.serve(refuse, 0.0, 2 * MOST_WAITING)
        self._errands.close(_PATIENCE_S)

    def _at_once(self) -> tuple[Command[Any], Future[Any]]:
        return self._commands.get_nowait()

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

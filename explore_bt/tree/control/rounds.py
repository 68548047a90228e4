"""The same child again: repeat while it succeeds, retry while it fails."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree.control.base import Decorator, Work

__all__ = ["Repeat", "Retry"]


class Repeat(Decorator):
    """Runs its child until it has succeeded ``times`` times; fails when the child fails.

    With a number, the next round begins within the same tick, as in BehaviorTree.CPP: after a round that took
    only one tick the tree is woken, so that what stands before and beside this node is asked again first.
    With None it goes on for ever and returns ``RUNNING`` after each round, as ``KeepRunningUntilFailure``:
    a child that succeeds at once is ticked once per tick, so the tick always ends. ``times`` may be changed
    between ticks.
    """

    def __init__(self, name: str, child: Behaviour, times: int | None) -> None:
        super().__init__(name, child)
        self.times = times

    def initialise(self) -> None:
        """No round is done."""
        self._done = 0

    def memory(self) -> Mapping[str, object]:
        """How many rounds are done."""
        return {"done": self._done}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Go on counting."""
        super().restore(memory)
        self._done = cast(int, memory["done"])

    def work(self) -> Work:
        """Tick the child, round after round."""
        while self.times is None or self._done < self.times:
            began = self.child.status is not Status.RUNNING
            status = yield from self.ticked(self.child)
            if status is not Status.SUCCESS:
                return status
            self._done += 1
            total = "" if self.times is None else f" of {self.times}"
            self.feedback_message = f"{self._done}{total} rounds done"
            if self.times is None:
                return Status.RUNNING
            if began and self._done < self.times:
                self.wake()
                return Status.RUNNING
        return Status.SUCCESS


class Retry(Decorator):
    """Runs a failing child again, up to ``retries`` more times; succeeds when the child does.

    The next attempt begins within the same tick, after the tree was woken as by ``Repeat``. ``retry: 2`` is
    BehaviorTree.CPP's ``RetryUntilSuccessful num_attempts=3``. ``retries`` may be changed between ticks.
    """

    def __init__(self, name: str, child: Behaviour, retries: int) -> None:
        super().__init__(name, child)
        self.retries = retries

    def initialise(self) -> None:
        """No attempt has failed."""
        self._failed = 0

    @property
    def tries_left(self) -> int:
        """How many more attempts there will be if the present one fails."""
        return self.retries - self._failed

    def memory(self) -> Mapping[str, object]:
        """How many attempts have failed."""
        return {"failed": self._failed}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Go on counting."""
        super().restore(memory)
        self._failed = cast(int, memory["failed"])

    def work(self) -> Work:
        """Tick the child, attempt after attempt."""
        while self._failed <= self.retries:
            began = self.child.status is not Status.RUNNING
            status = yield from self.ticked(self.child)
            if status is not Status.FAILURE:
                return status
            self._failed += 1
            self.feedback_message = f"{self._failed} of {self.retries + 1} attempts failed"
            if began and self._failed <= self.retries:
                self.wake()
                return Status.RUNNING
        return Status.FAILURE

"""What has come over a network that may drop, delay and repeat."""

from __future__ import annotations

import threading
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from explore_bt.interfaces import Letter

__all__ = ["Inbox"]

_PATIENCE_S = 1.0
"""A gap may be words on their way; nobody is asked more often than this."""
_MOST_KEPT = 100_000


@dataclass
class _Sender:
    """One life of a robot.

    Attributes:
        whole: all words up to this number have come, or newer ones on their topics.
        later: numbers of words that came beyond a gap.
        newest: number of the newest word on each topic.
    """

    life: int
    whole: int = 0
    later: set[int] = field(default_factory=set)
    newest: dict[str, int] = field(default_factory=dict)
    asked_s: float = -1.0


class Inbox:
    """Lets the newest of every topic through, once, and knows who is to be asked for what is missing.

    ``put`` may be called by any thread.
    """

    def __init__(self) -> None:
        self.failed = self._came = self._asked = 0
        self._lock = threading.Lock()
        self._senders: dict[str, _Sender] = {}
        self._fresh: dict[tuple[str, str], Letter] = {}

    def put(self, letter: Letter, life: int, number: int, *, is_counted: bool = True) -> None:
        """A word has come: the ``number``-th of that life of its speaker.

        Those that are not counted have numbers of their own, and nobody is asked for them.
        """
        with self._lock:
            sender = self._senders.get(letter.sender)
            if sender is None or life > sender.life:
                sender = self._senders[letter.sender] = _Sender(life)
            if life < sender.life:
                return
            self._came += 1
            if is_counted and number > sender.whole and len(sender.later) < _MOST_KEPT:
                sender.later.add(number)
                _advance(sender)
            if number > sender.newest.get(letter.topic, 0):
                sender.newest[letter.topic] = number
                key = (letter.sender, letter.topic)
                self._fresh.pop(key, None)  # to the end
                self._fresh[key] = letter

    def answered(self, name: str, life: int, number: int, told: Collection[int]) -> None:
        """A robot that was asked has told the newest of all its topics, up to its ``number``-th word.

        Args:
            name: the robot's.
            life: of the robot.
            number: of its newest word then.
            told: numbers of the words that it answered with; some may have been lost.
        """
        with self._lock:
            sender = self._senders.get(name)
            if sender is None or sender.life != life or number <= sender.whole:
                return
            if any(each > sender.whole and each not in sender.later for each in told):
                return
            sender.whole = number
            sender.later = {later for later in sender.later if later > number}
            _advance(sender)

    def drain(self) -> list[Letter]:
        """What is new since the last call."""
        with self._lock:
            fresh, self._fresh = self._fresh, {}
        return list(fresh.values())

    def missing(self, now_s: float) -> list[tuple[str, int]]:
        """Whom to ask for everything after which number; asked again until ``answered``."""
        found = []
        with self._lock:
            for name, sender in self._senders.items():
                if not sender.later or now_s - sender.asked_s < _PATIENCE_S:
                    continue
                sender.asked_s = now_s
                self._asked += 1
                found.append((name, sender.whole))
        return found

    def figures(self) -> Mapping[str, float]:
        """``words_heard``, ``gaps_asked_for``, ``words_failed``."""
        return {
            "words_heard": float(self._came),
            "gaps_asked_for": float(self._asked),
            "words_failed": float(self.failed),
        }


def _advance(sender: _Sender) -> None:
    while sender.whole + 1 in sender.later:
        sender.whole += 1
        sender.later.discard(sender.whole)

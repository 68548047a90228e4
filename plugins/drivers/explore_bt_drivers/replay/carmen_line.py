"""One line of a CARMEN log, taken apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import LogCutOff, LogError
from explore_bt.types import Pose2

__all__ = ["CarmenLine"]


class CarmenLine:
    """The words of a line, read one after the other; what is wrong is told with the line's number."""

    def __init__(self, path: Path, number: int, text: bytes) -> None:
        self._place = f"{path}:{number}"
        self._words = text.decode("ascii", errors="replace").split()
        self._next = 1
        self.is_ended = text.endswith(b"\n")

    @property
    def name(self) -> str:
        """The message's name, empty for a blank line, ``#`` for a comment."""
        name = self._words[0] if self._words else ""
        return "#" if name.startswith("#") else name

    def number(self, what: str) -> float:
        """The next word as a finite number."""
        word = self._word(what)
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.fault(f'{what} is "{word}"; expected a finite number')
        return value

    def count(self, what: str) -> int:
        """The next word as a number of things that this line still holds."""
        word = self._word(what)
        if not (word.isascii() and word.isdigit()):
            raise self.fault(f'{what} is "{word}"; expected a count')
        left = len(self._words) - self._next
        if len(word) > 9 or int(word) > left:
            raise self.fault(f"{what} is {word}, but only {left} words follow", cut=True)
        return int(word)

    def pose(self, what: str) -> Pose2:
        """The next three words as x, y in metres and a heading in radians."""
        return Pose2(self.number(f"{what} x"), self.number(f"{what} y"), self.number(f"{what} theta"))

    def ranges(self, count: int) -> NDArray[np.float64]:
        """The next words as ranges, metres: (count,) float64, NaN and infinity as they are written.

        A zero, which drivers write for a beam without an answer, is made NaN.
        """
        words = self._words[self._next : self._next + count]
        try:
            ranges = np.array(words, dtype=np.float64)
        except ValueError:
            raise self._wrong_range(words) from None
        if (ranges < 0.0).any():
            raise self._wrong_range(words)
        self._next += count
        ranges[ranges == 0.0] = math.nan
        return ranges

    def end(self, skipped: int, what: str) -> None:
        """``skipped`` more words follow, and nothing behind them."""
        found = len(self._words) - self._next
        if found != skipped:
            message = f"words left on the line: {found}; expected {skipped} ({what})"
            raise self.fault(message, cut=found < skipped)

    def fault(self, message: str, *, cut: bool = False) -> LogError:
        """An error that names this line.

        Args:
            message: what was found, and what was expected.
            cut: whether words are missing: of the last line, without its line end, that says "cut off".
        """
        if cut and not self.is_ended:
            return LogCutOff(f"{self._place}: cut off: the file ends in the middle of this {self.name} line")
        words = f"{self.name}: {message}"
        return LogError(f"{self._place}: {''.join(c if c.isprintable() else '�' for c in words)}")

    def _word(self, what: str) -> str:
        if self._next >= len(self._words):
            raise self.fault(f"ends before {what}", cut=True)
        self._next += 1
        return self._words[self._next - 1]

    def _wrong_range(self, words: Sequence[str]) -> LogError:
        index = next(index for index, word in enumerate(words) if not _is_range(word))
        return self.fault(f'range {index} is "{words[index]}"; expected metres, 0 or more')


def _is_range(word: str) -> bool:
    try:
        return not float(word) < 0.0
    except ValueError:
        return False

"""Lines from a person at a terminal, or from a script."""

from __future__ import annotations

import select
import sys
from collections.abc import Callable
from typing import TextIO

__all__ = ["LineReader"]


class LineReader:
    """Reads commands: with line editing and history from a terminal, echoing them from anything else.

    Args:
        echo: prints what was read from a script, so that its output can be understood.
        lines: where they come from; standard input by default.
    """

    def __init__(self, echo: Callable[[str], None], lines: TextIO | None = None) -> None:
        self._lines = lines or sys.stdin
        self._echo = echo
        self.is_interactive = self._lines is sys.stdin and sys.stdin.isatty()
        if self.is_interactive:
            import readline  # noqa: F401  # its import gives input() line editing and history

    def read(self, prompt: str) -> str:
        """The next line.

        Raises:
            EOFError: there is none.
            KeyboardInterrupt: Ctrl-C.
        """
        if self.is_interactive:
            return input(prompt)
        line = self._lines.readline()
        if not line:
            raise EOFError
        self._echo(f"{prompt}{line.rstrip()}")
        return line.rstrip("\n")

    def typed_meanwhile(self) -> str | None:
        """A line that a person has typed while something else was going on; None if there is none."""
        if self.is_interactive and select.select([self._lines], [], [], 0.0)[0]:
            return self._lines.readline() or None
        return None

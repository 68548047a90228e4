"""Texts that a mission is made of, and places in them."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

__all__ = ["Place", "Source"]


@dataclass(frozen=True, slots=True)
class Source:
    """A mission file, an included file, or an override.

    Attributes:
        name: what people are shown.
        folder: what relative file names in it are relative to; made absolute.
        has_lines: False for an override, whose place is its name alone.
    """

    name: str
    text: str
    folder: Path
    has_lines: bool = True
    lines: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lines", tuple(self.text.split("\n")))
        object.__setattr__(self, "folder", Path(os.path.abspath(self.folder)))

    def place(self, line: int = 1, column: int = 1, width: int = 1) -> Place:
        """A place in this text."""
        return Place(self, line, column, width)


@dataclass(frozen=True, slots=True)
class Place:
    """Where something stands: line and column from 1, and how many characters it takes."""

    source: Source
    line: int
    column: int
    width: int = 1

    def __str__(self) -> str:
        name = self.source.name
        return f"{name}:{self.line}:{self.column}" if self.source.has_lines else name

    @property
    def excerpt(self) -> str:
        """The line of text."""
        lines = self.source.lines
        return lines[self.line - 1].rstrip("\r") if self.line <= len(lines) else ""
